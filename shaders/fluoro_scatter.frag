// SPDX-License-Identifier: MIT
// Where scattered quanta come from, at 1/8 of the picture's size: scatter is made where matter is
// and must get out again, so by
// depth * exp(-depth); and beside them the depth itself, for the screen's equalisation.
// uDepth         sampler2D  optical depth, full size
#version 450 core
in vec2 vUv;
layout(binding = 0) uniform sampler2D uDepth;
layout(location = 0) out vec2 oScatterDepth;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * 8, last = textureSize(uDepth, 0) - 1;
  vec2 sum = vec2(0.0);
  for (int k = 0; k < 16; ++k) {
    ivec2 p = min(first + ivec2(2 * (k & 3), 2 * (k >> 2)), last);
    float d = max(texelFetch(uDepth, p, 0).r, 0.0);
    sum += vec2(d * exp(-d), d);
  }
  oScatterDepth = sum / 16.0;
}
