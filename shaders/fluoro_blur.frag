// SPDX-License-Identifier: MIT
// Gaussian blur of a float picture of one or two channels along one axis.
// uSource        sampler2D
// uStep          ivec2 (1,0) or (0,1)
// uSigma         float pixels; 0 copies
#version 450 core
in vec2 vUv;
layout(binding = 0) uniform sampler2D uSource;
uniform ivec2 uStep;
uniform float uSigma;
layout(location = 0) out vec2 oValue;

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy), last = textureSize(uSource, 0) - 1;
  int reach = int(ceil(2.5 * uSigma));
  vec2 sum = vec2(0.0);
  float weight = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    float w = exp(-0.5 * float(i * i) / max(uSigma * uSigma, 1e-6));
    sum += w * texelFetch(uSource, clamp(p + i * uStep, ivec2(0), last), 0).rg;
    weight += w;
  }
  oValue = sum / weight;
}
