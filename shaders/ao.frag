// SPDX-License-Identifier: MIT
// Screen-space ambient occlusion at a share of the size: taps on a spiral, turned by a fixed 4 x 4 pixel
// pattern (static, so nothing flickers; blur.frag removes the pattern).
// uDepth         sampler2D  depth 0..1, full size
// uNearFar       vec3  near, far (m), 1 = perspective / 0 = orthographic
// uTanHalf       vec2  half picture at depth 1 m (perspective) or half picture in m (orthographic)
// uSize          vec2  full size in pixels
// uShare         int   full pixels to one of these, along each axis
// uRadius        float metres
// uPixelsPerMetre vec2 x: scale at depth 1 m (perspective), y: constant (orthographic)
// uTaps          int   4..32
// uSpiral[32]    vec2  tap offsets within the unit disc
#version 450 core
in vec2 vUv;
layout(binding = 0) uniform sampler2D uDepth;
uniform vec3 uNearFar;
uniform vec2 uTanHalf, uSize, uPixelsPerMetre;
uniform float uRadius;
uniform int uTaps, uShare;
uniform vec2 uSpiral[32];
layout(location = 0) out vec2 oLightDepth;  // occlusion, linear depth (m)

const vec2 kTurn[16] = vec2[](  // cos, sin of k/16 turn
    vec2(1.0, 0.0), vec2(0.92388, 0.38268), vec2(0.70711, 0.70711), vec2(0.38268, 0.92388),
    vec2(0.0, 1.0), vec2(-0.38268, 0.92388), vec2(-0.70711, 0.70711), vec2(-0.92388, 0.38268),
    vec2(-1.0, 0.0), vec2(-0.92388, -0.38268), vec2(-0.70711, -0.70711), vec2(-0.38268, -0.92388),
    vec2(0.0, -1.0), vec2(0.38268, -0.92388), vec2(0.70711, -0.70711), vec2(0.92388, -0.38268));

// Position relative to the eye: x right, y up, z away from the viewer, metres.
vec3 at(vec2 pixel) {
  ivec2 p = ivec2(clamp(pixel, vec2(0.0), uSize - 1.0));
  float d = texelFetch(uDepth, p, 0).r, n = uNearFar.x, f = uNearFar.y;
  bool perspective = uNearFar.z > 0.5;
  float z = perspective ? n * f / (f - d * (f - n)) : mix(n, f, d);
  return vec3(((vec2(p) + 0.5) / uSize * 2.0 - 1.0) * uTanHalf * (perspective ? z : 1.0), z);
}

void main() {
  vec2 p = float(uShare) * floor(gl_FragCoord.xy) + float(uShare / 2);
  oLightDepth = vec2(1.0, 1e3);
  if (texelFetch(uDepth, ivec2(p), 0).r >= 1.0) return;
  vec3 c = at(p);
  // the smaller of the two one-sided differences does not reach across an edge
  vec3 r = at(p + vec2(1, 0)) - c, l = c - at(p - vec2(1, 0));
  vec3 t = at(p + vec2(0, 1)) - c, b = c - at(p - vec2(0, 1));
  vec3 n = normalize(cross(abs(t.z) < abs(b.z) ? t : b, abs(r.z) < abs(l.z) ? r : l));
  float radius_px = uRadius * (uPixelsPerMetre.y + uPixelsPerMetre.x / max(c.z, 1e-3));
  int cell = (int(gl_FragCoord.x) & 3) + 4 * (int(gl_FragCoord.y) & 3);
  vec2 turn = kTurn[(cell * 7) & 15] * radius_px;
  float sum = 0.0, bias = 0.02 * uRadius, fade = 1.0 / (uRadius * uRadius);
  for (int i = 0; i < uTaps; ++i) {
    vec2 s = uSpiral[i];
    vec3 d = at(p + vec2(s.x * turn.x - s.y * turn.y, s.x * turn.y + s.y * turn.x)) - c;
    float dd = dot(d, d);
    sum += max(1.0 - dd * fade, 0.0) * max(dot(d, n) - bias, 0.0) * inversesqrt(dd + 1e-9);
  }
  oLightDepth = vec2(clamp(1.0 - 2.2 * sum / float(uTaps), 0.0, 1.0), c.z);
}
