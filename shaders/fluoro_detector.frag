// SPDX-License-Identifier: MIT
// Quanta that a detector pixel counts, relative to the open field: Beer-Lambert primary, scatter,
// collimator blades and quantum noise.
// uDepth         sampler2D  optical depth, dimensionless; faces missed (fluoro_length.frag)
// uScatter       sampler2D  blurred scatter source, 1/8 size
// uScatterGain   float scatter to primary ratio over optical depth at the reference
// uQuanta        float quanta of the open field in one pixel; 0 = no noise
// uField         vec4  half width, half height, corner radius, penumbra of the field, pixels;
//                      half width 0 = no collimator
// uCentre        vec2  middle of the field, pixels
// uFrame         int   noise is a function of pixel and frame alone
#version 450 core
in vec2 vUv;
layout(binding = 0) uniform sampler2D uDepth;
layout(binding = 1) uniform sampler2D uScatter;
uniform float uScatterGain, uQuanta;
uniform vec4 uField;
uniform vec2 uCentre;
uniform int uFrame;
layout(location = 0) out float oSignal;

uvec3 pcg3d(uvec3 v) {  // Jarzynski & Olano 2020, counter-based
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  return v;
}

// Share of the beam that the blades let through: a rounded rectangle with a soft edge.
float field(vec2 pixel) {
  if (uField.x <= 0.0) return 1.0;
  vec2 q = abs(pixel - uCentre) - uField.xy + uField.z;
  float outside = length(max(q, 0.0)) + min(max(q.x, q.y), 0.0) - uField.z;
  return smoothstep(uField.w, -uField.w, outside);
}

// Where a face was missed, the mean of the neighbours where none was.
float opticalDepth(ivec2 p) {
  vec2 d = texelFetch(uDepth, p, 0).rg;
  float sum = 0.0, n = 0.0;
  ivec2 last = textureSize(uDepth, 0) - 1;
  for (int k = 0; k < 9; ++k) {
    vec2 q = texelFetch(uDepth, clamp(p + ivec2(k % 3, k / 3) - 1, ivec2(0), last), 0).rg;
    float whole = float(abs(q.g) < 0.5);
    sum += whole * q.r;
    n += whole;
  }
  return abs(d.g) < 0.5 || n < 0.5 ? d.r : sum / n;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  float open = field(gl_FragCoord.xy);
  float primary = exp(-opticalDepth(p));
  float scatter = uScatterGain > 0.0 ? uScatterGain * texture(uScatter, vUv).r : 0.0;
  float signal = open * (primary + scatter);
  if (uQuanta > 0.0) {
    // Poisson, as a normal of the same mean and variance: fine above some ten quanta, which scatter
    // alone brings behind the densest barium
    uvec3 r = pcg3d(uvec3(p, uFrame));
    vec2 u = (vec2(r.xy >> 8u) + 0.5) / 16777216.0;
    float normal = sqrt(-2.0 * log(u.x)) * cos(6.2831853 * u.y);
    signal = max(signal + normal * sqrt(signal / uQuanta), 0.0);
  }
  oSignal = signal;
}
