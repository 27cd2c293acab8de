// SPDX-License-Identifier: MIT
// Ray length through closed meshes times attenuation, by addition: back faces add their distance,
// front faces take theirs away (blend ONE, ONE into a float target).
// uAttenuation   float 1/m, above the soft tissue around
// uEye           vec4  w = 1: eye position (m); w = 0: direction towards the eye
#version 450 core
in vec3 vPosition;
uniform float uAttenuation;
uniform vec4 uEye;
layout(location = 0) out float oDepth;

void main() {
  float d = uEye.w > 0.5 ? distance(uEye.xyz, vPosition) : -dot(uEye.xyz, vPosition);
  oDepth = (gl_FrontFacing ? -d : d) * uAttenuation;
}
