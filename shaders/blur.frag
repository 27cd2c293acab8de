// SPDX-License-Identifier: MIT
// 4 x 4 box over the occlusion, as wide as ao.frag's pattern, ignoring other depths.
// uLightDepth    sampler2D  occlusion, linear depth (m)
// uRange         float metres beyond which a neighbour does not count
#version 450 core
in vec2 vUv;
layout(binding = 0) uniform sampler2D uLightDepth;
uniform float uRange;
layout(location = 0) out vec2 oLightDepth;

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy), last = textureSize(uLightDepth, 0) - 1;
  vec2 centre = texelFetch(uLightDepth, p, 0).rg;
  oLightDepth = centre;
  if (centre.g > 100.0) return;  // background
  float sum = 0.0, weight = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      vec2 q = texelFetch(uLightDepth, clamp(p + ivec2(x, y), ivec2(0), last), 0).rg;
      float w = max(1.0 - abs(q.g - centre.g) / uRange, 0.0) + 1e-4;
      sum += w * q.r;
      weight += w;
    }
  oLightDepth.r = sum / weight;
}
