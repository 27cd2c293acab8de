// SPDX-License-Identifier: MIT
// Surface shading in linear light: diffuse that wraps round translucent tissue, a GGX lobe, a thin
// water coat with a soft-box reflection, and a filtered key shadow. Output: highlights compressed,
// square root of the linear colour (so that 8 bits suffice). DETAIL: with mottle and relief.
// uBase, uSpecular(0..1), uRoughness(0.05..1), uTranslucency, uWetness, uMottle (0..1)
// uRelief        float 0..1, height of bumps fixed to the tissue; uReliefSize metres between them
// uOpacity       float 0..1; below 1 grazing rays are more opaque, as in glass
// uId            float alpha of what is opaque: which structure is seen, n / 255
// uExposure      float
// uToneMap       int   1 = soft shoulder above 0.7, 0 = clamp
// uEye           vec4  w = 1: eye position (m); w = 0: direction towards the eye
// uUp            vec3  the view's up axis
// uKeyDir, uKey, uFillDir, uFill   vec3  unit direction to the light; linear radiance
// uAmbientTop, uAmbientBottom      vec3  linear radiance from above and below
// uShadowProj    mat4  shadow map from world, 0..1
// uShadowStrength, uShadowRadius   float 0..1; filter radius in map coordinates
// uShadowBias    float metres along the normal
#version 450 core
in vec3 vPosition;
in vec3 vNormal;
in vec3 vRest;
uniform vec3 uBase;
uniform float uSpecular, uRoughness, uTranslucency, uWetness, uMottle, uOpacity, uId;
uniform float uRelief, uReliefSize;
uniform int uToneMap;
uniform float uExposure;
uniform vec4 uEye;
uniform vec3 uUp, uKeyDir, uKey, uFillDir, uFill, uAmbientTop, uAmbientBottom;
uniform mat4 uShadowProj;
uniform float uShadowStrength, uShadowRadius, uShadowBias;
layout(binding = 0) uniform sampler2DShadow uShadow;
layout(location = 0) out vec4 oColour;

// A turned square; the comparison sampler smooths each tap.
const vec2 kDisc[4] = vec2[](vec2(0.6, 0.2), vec2(-0.2, 0.6), vec2(-0.6, -0.2), vec2(0.2, -0.6));

float hash(ivec3 c) {  // integer hash: the same on every machine
  uint h = uint(c.x) * 73856093u ^ uint(c.y) * 19349663u ^ uint(c.z) * 83492791u;
  h = (h ^ (h >> 15)) * 2246822519u;
  h = (h ^ (h >> 13)) * 3266489917u;
  return float(h >> 8) * (1.0 / 16777216.0);
}

// Value noise (x) and its gradient (yzw), cubic fade.
vec4 noise(vec3 p) {
  ivec3 c = ivec3(floor(p));
  vec3 f = p - vec3(c);
  vec3 u = f * f * (3.0 - 2.0 * f), du = 6.0 * f * (1.0 - f);
  float a = hash(c), b = hash(c + ivec3(1, 0, 0)), d = hash(c + ivec3(0, 1, 0)),
        e = hash(c + ivec3(1, 1, 0)), g = hash(c + ivec3(0, 0, 1)),
        h = hash(c + ivec3(1, 0, 1)), k = hash(c + ivec3(0, 1, 1)), l = hash(c + ivec3(1, 1, 1));
  float x0 = mix(a, b, u.x), x1 = mix(d, e, u.x), x2 = mix(g, h, u.x), x3 = mix(k, l, u.x);
  float y0 = mix(x0, x1, u.y), y1 = mix(x2, x3, u.y);
  float dx = mix(mix(b - a, e - d, u.y), mix(h - g, l - k, u.y), u.z);
  return vec4(mix(y0, y1, u.z),
              du * vec3(dx, mix(x1 - x0, x3 - x2, u.z), y1 - y0));
}

float shadow(vec3 n) {
  vec3 p = (uShadowProj * vec4(vPosition + n * uShadowBias, 1.0)).xyz;
  float lit = 0.0;
  for (int i = 0; i < 4; ++i) lit += texture(uShadow, vec3(p.xy + uShadowRadius * kDisc[i], p.z));
  return mix(1.0, lit / 4.0, uShadowStrength);
}

// GGX distribution with Smith's height-correlated visibility, times pi.
float ggx(float nl, float nv, float nh, float alpha) {
  float a2 = alpha * alpha, d = nh * nh * (a2 - 1.0) + 1.0;
  float v = nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2);
  return a2 / (d * d) * 0.5 / max(v, 1e-4);
}

float fresnel(float f0, float c) {
  float d = 1.0 - c, d2 = d * d;
  return f0 + (1.0 - f0) * d2 * d2 * d;
}

vec3 directional(vec3 base, vec3 n, vec3 v, vec3 dir, vec3 radiance) {
  float c = dot(n, dir), w = 0.6 * uTranslucency;
  float nl = max(c, 0.0), wrapped = max((c + w) / ((1.0 + w) * (1.0 + w)), 0.0);
  vec3 tint = base / max(max(base.r, base.g), max(base.b, 1e-3));
  vec3 light = base * mix(vec3(wrapped), vec3(nl), 1.0 - uTranslucency) +
               base * tint * tint * max(wrapped - nl, 0.0) * uTranslucency;
  if (nl <= 0.0) return radiance * light;
  vec3 h = normalize(dir + v);
  float nv = max(dot(n, v), 1e-3), nh = max(dot(n, h), 0.0), vh = max(dot(v, h), 0.0);
  float lobe = ggx(nl, nv, nh, uRoughness * uRoughness) * fresnel(0.08 * uSpecular, vh);
  float coat = uWetness * ggx(nl, nv, nh, 0.035) * fresnel(0.02, vh);  // water n = 1.33
  return radiance * (light + nl * (lobe + coat));
}

// What a wet surface mirrors: a dim room with one soft box above.
vec3 room(vec3 r) {
  float up = dot(r, uUp);
  float box = smoothstep(0.72, 0.95, dot(r, normalize(uKeyDir + 0.35 * uUp)));
  return mix(uAmbientBottom, uAmbientTop, smoothstep(-0.6, 0.8, up)) + 0.9 * box * uKey;
}

vec4 encoded(vec3 c, float alpha) {
  c *= uExposure;
  const float knee = 0.7;  // identity below, then towards 1 without a corner
  vec3 over = max(c - knee, 0.0) / (1.0 - knee);
  if (uToneMap == 1) c = min(c, vec3(knee)) + (1.0 - knee) * over / (1.0 + over);
  return vec4(sqrt(clamp(c, 0.0, 1.0)), alpha);
}

void main() {
  vec3 v = normalize(uEye.xyz - uEye.w * vPosition);
  vec3 n = normalize(vNormal);
  if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n;
  vec3 base = uBase;
  vec3 flatN = n;
#ifdef DETAIL
  // bumps smaller than a pixel would flicker: they fade first
  float footprint = length(fwidth(vRest)) / uReliefSize;
  float seen = clamp(1.6 - 1.6 * footprint, 0.0, 1.0);
  vec4 fine = noise(vRest / uReliefSize), coarse = noise(vRest * 190.0);
  base *= 1.0 + uMottle * (0.55 * (coarse.x - 0.5) + 0.35 * seen * (fine.x - 0.5));
  vec3 g = fine.yzw;  // rest axes: tissue turns little, so the slope is used as it is
  n = normalize(n - 0.35 * seen * uRelief * (g - dot(g, n) * n));
  base *= 1.0 + 0.25 * seen * uRelief * (fine.x - 0.6);  // hollows are darker
#endif
  float lit = shadow(flatN);
  float up = 0.5 + 0.5 * dot(n, uUp);
  vec3 colour = base * mix(uAmbientBottom, uAmbientTop, up);
  colour += lit * directional(base, n, v, uKeyDir, uKey);
  colour += directional(base, n, v, uFillDir, uFill);
  float nv = max(dot(n, v), 0.0);
  float graze = max(nv, 0.2);  // interpolated normals lie at silhouettes: no white rims
  float mirror = uWetness * fresnel(0.02, graze) + 0.5 * (1.0 - uRoughness) *
                 fresnel(0.08 * uSpecular, graze);
  colour += mix(0.35, 1.0, lit) * mirror * room(reflect(-v, n));
  float glass = clamp(uOpacity * (0.55 + 1.3 * (1.0 - nv) * (1.0 - nv)), 0.0, 1.0);
  oColour = encoded(colour, uOpacity < 1.0 ? glass : uId);
}
