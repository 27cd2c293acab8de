// SPDX-License-Identifier: MIT
// Occlusion, background, sRGB.
// uColour        sampler2D  square root of linear, premultiplied
// uLightDepth    sampler2D  half size: occlusion 0 dark .. 1 open, linear depth (m)
// uDepth         sampler2D  depth 0..1
// uNearFar       vec3  near, far (m), 1 = perspective / 0 = orthographic
// uRange         float metres beyond which another depth's occlusion does not count
// uAoStrength    float 0..1
// uTop, uBottom  vec3  background, sRGB
#version 450 core
in vec2 vUv;
layout(binding = 0) uniform sampler2D uColour;
layout(binding = 1) uniform sampler2D uLightDepth;
layout(binding = 2) uniform sampler2D uDepth;
uniform vec3 uNearFar;
uniform float uAoStrength, uRange;
uniform vec3 uTop, uBottom;
layout(location = 0) out vec4 oColour;

vec3 toSrgb(vec3 c) {  // IEC 61966-2-1
  return mix(12.92 * c, 1.055 * pow(max(c, 1e-6), vec3(1.0 / 2.4)) - 0.055,
             greaterThan(c, vec3(0.0031308)));
}

// Enlarges the occlusion: bilinear weights, less for texels at another depth.
float occlusion(ivec2 p) {
  float d = texelFetch(uDepth, p, 0).r, n = uNearFar.x, f = uNearFar.y;
  if (d >= 1.0) return 1.0;
  float z = uNearFar.z > 0.5 ? n * f / (f - d * (f - n)) : mix(n, f, d);
  ivec2 last = textureSize(uLightDepth, 0) - 1;
  ivec2 q = p / 2, side = p & 1;
  float sum = 0.0, weight = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 o = ivec2(k & 1, k >> 1);
    vec2 s = texelFetch(uLightDepth, min(q + o, last), 0).rg;
    vec2 share = mix(vec2(1 - o), vec2(0.5), vec2(side));
    float w = share.x * share.y * (max(1.0 - abs(s.g - z) / uRange, 0.0) + 1e-3);
    sum += w * s.r;
    weight += w;
  }
  return sum / weight;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  vec4 c = texelFetch(uColour, p, 0);
  float ao = uAoStrength > 0.0 ? mix(1.0, occlusion(p), uAoStrength) : 1.0;
  vec3 sky = mix(uBottom, uTop, smoothstep(0.0, 1.0, vUv.y));
  // half a level of fixed ordered noise hides the bands of the dark background
  sky += (float((p.x * 5 + p.y * 3) & 7) / 8.0 - 0.4375) / 255.0;
  if (c.a <= 0.0) {
    oColour = vec4(sky, 1.0);
    return;
  }
  vec3 colour = c.rgb / c.a;
  colour *= colour;
  // light that bounces between tissue walls keeps their colour: dark creases stay warm
  vec3 hue = colour / max(max(colour.r, colour.g), max(colour.b, 1e-4));
  colour *= pow(vec3(ao), 1.35 - 0.6 * hue);
  oColour = vec4(mix(sky, toSrgb(clamp(colour, 0.0, 1.0)), c.a), 1.0);
}
