// SPDX-License-Identifier: MIT
// Depth or stencil only (shadow map, section counting, ghost prepass). No uniforms.
#version 450 core

void main() {}
