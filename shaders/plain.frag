// SPDX-License-Identifier: MIT
// One white light from the viewer, one colour: the least that shows a shape.
// uEye           vec4  w = 1: eye position (m); w = 0: direction towards the eye
#version 450 core
in vec3 vPosition;
in vec3 vNormal;
uniform vec4 uEye;
layout(location = 0) out vec4 oColour;

void main() {
  vec3 v = normalize(uEye.xyz - uEye.w * vPosition);
  oColour = vec4(vec3(abs(dot(normalize(vNormal), v))), 1.0);
}
