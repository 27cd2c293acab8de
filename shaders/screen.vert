// SPDX-License-Identifier: MIT
// One triangle over the whole picture, at the far plane; no attributes, no uniforms.
#version 450 core
out vec2 vUv;  // 0..1, origin at the lower left

void main() {
  vUv = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(vUv * 2.0 - 1.0, 1.0, 1.0);
}
