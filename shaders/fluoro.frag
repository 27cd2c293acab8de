// SPDX-License-Identifier: MIT
// Beer-Lambert picture of a summed attenuation: detector blur, quantum noise, display grey.
// uDepth         sampler2D  optical depth above the soft tissue around, dimensionless
// uTissue        float optical depth of that tissue
// uExposure      float display gain
// uNoise         float relative to the unattenuated signal
// uBlur          float pixels
// uDark          int   1 = absorbers dark, 0 = inverted
// uFrame         int   a new grain for every frame, the same grain for the same frame
#version 450 core
in vec2 vUv;
layout(binding = 0) uniform sampler2D uDepth;
uniform float uTissue, uExposure, uNoise, uBlur;
uniform int uDark, uFrame;
layout(location = 0) out vec4 oColour;

float hash(uvec3 c) {
  uint h = c.x * 73856093u ^ c.y * 19349663u ^ c.z * 83492791u;
  h = (h ^ (h >> 15)) * 2246822519u;
  h = (h ^ (h >> 13)) * 3266489917u;
  return float((h ^ (h >> 16)) >> 8) / 16777216.0;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy), last = textureSize(uDepth, 0) - 1;
  float sum = 0.0, weight = 0.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      float w = exp(-0.5 * float(x * x + y * y) / max(uBlur * uBlur, 1e-3));
      sum += w * exp(-max(texelFetch(uDepth, clamp(p + ivec2(x, y), ivec2(0), last), 0).r, -1.0));
      weight += w;
    }
  float signal = sum / weight;  // 1 = soft tissue around only
  // quantum noise: relative to its own root, stronger where less arrives; sum of four is near normal
  float grain = -2.0;
  for (uint k = 0u; k < 4u; ++k) grain += hash(uvec3(p, uint(uFrame) * 4u + k));
  signal += uNoise * grain * sqrt(max(signal, 0.0)) * exp(0.25 * uTissue);
  // logarithmic display, as an image intensifier chain compresses: tissue around at 0.72
  float grey = 0.72 + 0.30 * log(max(signal, 1e-3));
  grey = clamp(grey * uExposure, 0.0, 1.0);
  oColour = vec4(vec3(uDark == 1 ? grey : 1.0 - grey), 1.0);
}
