// SPDX-License-Identifier: MIT
// The picture darkened by occlusion; drawn where there is something nearer than the background.
// Output as the input: square root of linear, and which structure is seen.
// uColour        sampler2D  square root of linear
// uLightDepth    sampler2D  a share of the size: occlusion 0 dark .. 1 open, linear depth (m)
// uDepth         sampler2D  depth 0..1
// uNearFar       vec3  near, far (m), 1 = perspective / 0 = orthographic
// uShare         int   pixels to one of uLightDepth, along each axis
// uRange         float metres beyond which another depth's occlusion does not count
// uAoStrength    float 0..1
#version 450 core
layout(binding = 0) uniform sampler2D uColour;
layout(binding = 1) uniform sampler2D uLightDepth;
layout(binding = 2) uniform sampler2D uDepth;
uniform vec3 uNearFar;
uniform int uShare;
uniform float uAoStrength, uRange;
layout(location = 0) out vec4 oColour;

// Enlarges the occlusion: bilinear weights, less for texels at another depth.
float occlusion(ivec2 p) {
  float d = texelFetch(uDepth, p, 0).r, n = uNearFar.x, f = uNearFar.y;
  float z = uNearFar.z > 0.5 ? n * f / (f - d * (f - n)) : mix(n, f, d);
  ivec2 last = textureSize(uLightDepth, 0) - 1;
  vec2 g = (vec2(p - uShare / 2)) / float(uShare);
  ivec2 q = ivec2(floor(g));
  vec2 s = g - vec2(q);
  float sum = 0.0, weight = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 o = ivec2(k & 1, k >> 1);
    vec2 t = texelFetch(uLightDepth, clamp(q + o, ivec2(0), last), 0).rg;
    vec2 share = mix(1.0 - s, s, vec2(o));
    float w = share.x * share.y * max(1.0 - abs(t.g - z) / uRange, 0.0) + 1e-4;
    sum += w * t.r;
    weight += w;
  }
  return sum / weight;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  vec4 c = texelFetch(uColour, p, 0);
  float ao = mix(1.0, occlusion(p), uAoStrength);
  // light that bounces between tissue walls keeps their colour: dark creases stay warm; of the
  // linear light ao^1.35 is left of the weakest colour, ao^0.75 of the strongest
  vec3 linear = c.rgb * c.rgb;
  vec3 hue = linear / max(max(linear.r, linear.g), max(linear.b, 1e-4));
  float half_ = sqrt(ao), quarter = sqrt(half_), eighth = sqrt(quarter);
  oColour = vec4(c.rgb * mix(vec3(half_ * eighth * sqrt(eighth)), vec3(quarter * eighth), hue), c.a);
}
