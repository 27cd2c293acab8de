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
  float n = 0.0;
  for (int k = 0; k < 16; ++k) {
    ivec2 p = min(first + ivec2(2 * (k & 3), 2 * (k >> 2)), last);
    vec2 t = texelFetch(uDepth, p, 0).rg;
    float d = max(t.r, 0.0), whole = float(abs(t.g) < 0.5);
    sum += whole * vec2(d * exp(-d), d);
    n += whole;
  }
  oScatterDepth = sum / max(n, 1.0);
}
