// SPDX-License-Identifier: MIT
// Detector signal to screen grey: the chain shows minus log of the signal, within a window
// about the depth that the exposure was set for. Equalisation takes off a share of what is smooth
// over centimetres, so that jaw and neck fit one window (as dynamic range compression does).
// uSignal        sampler2D  relative to the open field
// uSmooth        sampler2D  green: optical depth, blurred
// uWindow        vec2  optical depths shown white and black
// uReference     float optical depth of the exposure
// uEqualisation  float share taken off, 0..1
// uGamma         float of the screen curve, 1 = straight
// uDark          int   1 = absorbers dark, 0 = inverted
#version 450 core
in vec2 vUv;
layout(binding = 0) uniform sampler2D uSignal;
layout(binding = 1) uniform sampler2D uSmooth;
uniform vec2 uWindow;
uniform float uReference, uEqualisation, uGamma;
uniform int uDark;
layout(location = 0) out vec4 oColour;

void main() {
  float depth = -log(max(texelFetch(uSignal, ivec2(gl_FragCoord.xy), 0).r, 1e-6));
  depth -= uEqualisation * (texture(uSmooth, vUv).g - uReference);
  float grey = clamp((uWindow.y - depth) / (uWindow.y - uWindow.x), 0.0, 1.0);
  grey = pow(grey, uGamma);
  if (uDark == 0) grey = depth < 12.0 ? 1.0 - grey : 0.0;  // blades stay black
  oColour = vec4(vec3(grey), 1.0);
}
