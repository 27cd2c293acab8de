// SPDX-License-Identifier: MIT
// Optical depth through closed meshes by signed ray lengths: a back face adds its distance times
// the attenuation, a front face takes its own away (blend ONE, ONE into a float target). The dense
// layer of bones is added at each face: its thickness over the cosine of the ray. The second channel
// counts back faces minus front faces, 0 along a ray through closed meshes; the distance of a face
// seen edge-on can be anything within a pixel, and the count tells then that it is not to be used.
// uAttenuation   float 1/m, more (or less) than that of what surrounds the mesh
// uLayer         float optical depth of the dense layer met at right angles, dimensionless
// uEye           vec4  w = 1: eye position (m); w = 0: direction towards the eye
// uReach         vec2  least and greatest distance of the mesh, less uOrigin (m)
// uOrigin        float distance (m) from the eye taken as zero, for the sake of precision
#version 450 core
in vec3 vPosition;
in vec3 vNormal;
uniform float uAttenuation, uLayer, uOrigin;
uniform vec2 uReach;
uniform vec4 uEye;
layout(location = 0) out vec2 oDepth;

const float kLongestWay = 5.0;  // through a thin layer at grazing rays: sqrt(2 R / t), R = 25 t / 2

void main() {
  vec3 v = uEye.w > 0.5 ? uEye.xyz - vPosition : uEye.xyz;
  float d = (uEye.w > 0.5 ? length(v) : -dot(v, vPosition)) - uOrigin;
  float side = gl_FrontFacing ? -1.0 : 1.0;
  oDepth = vec2(side * d * uAttenuation, side);
  if (d < uReach.x || d > uReach.y) oDepth = vec2(0.0, 1e3);
  if (uLayer > 0.0) {
    float c = abs(dot(normalize(vNormal), normalize(v)));
    oDepth.r += uLayer / max(c, 1.0 / kLongestWay);
  }
}
