// SPDX-License-Identifier: MIT
// One colour: outlines of sections, and structures by number.
// uBase          vec3  linear
// uId            float written to alpha: which structure is seen, n / 255
#version 450 core
uniform vec3 uBase;
uniform float uId;
layout(location = 0) out vec4 oColour;

void main() { oColour = vec4(sqrt(uBase), uId); }
