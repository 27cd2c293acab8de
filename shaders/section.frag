// SPDX-License-Identifier: MIT
// The face of a cut, read as a diagram: the same light at any angle, less in the key shadow. Output
// as that of solid.frag.
// uBase, uId, uExposure, uToneMap, uShadow*, uKey, uFill, uAmbientTop, uAmbientBottom  as there
#version 450 core
in vec3 vPosition;
in vec3 vNormal;
uniform vec3 uBase, uKey, uFill, uAmbientTop, uAmbientBottom;
uniform float uExposure, uId;
uniform int uToneMap;
uniform mat4 uShadowProj;
uniform float uShadowStrength, uShadowRadius, uShadowBias;
layout(binding = 0) uniform sampler2DShadow uShadow;
layout(location = 0) out vec4 oColour;

const vec2 kDisc[4] = vec2[](vec2(0.6, 0.2), vec2(-0.2, 0.6), vec2(-0.6, -0.2), vec2(0.2, -0.6));

void main() {
  vec3 p = (uShadowProj * vec4(vPosition + vNormal * uShadowBias, 1.0)).xyz;
  float lit = 0.0;
  for (int i = 0; i < 4; ++i) lit += texture(uShadow, vec3(p.xy + uShadowRadius * kDisc[i], p.z));
  lit = mix(1.0, lit / 4.0, uShadowStrength);
  vec3 light = 0.5 * (uAmbientTop + uAmbientBottom) + 0.5 * lit * uKey + 0.3 * uFill;
  vec3 c = uBase * light * uExposure;
  const float knee = 0.7;
  vec3 over = max(c - knee, 0.0) / (1.0 - knee);
  if (uToneMap == 1) c = min(c, vec3(knee)) + (1.0 - knee) * over / (1.0 + over);
  oColour = vec4(sqrt(clamp(c, 0.0, 1.0)), uId);
}
