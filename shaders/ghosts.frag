// SPDX-License-Identifier: MIT
// Ghosted structures over each other, nearest first, whatever the order they were drawn in.
// Output: colour times opacity, and the opacity of all of them together.
// uColour        sampler2D[]  one structure each: square root of linear, opacity (0 elsewhere)
// uDepth         sampler2D[]  its depth 0..1
// uCount         int          how many of them
#version 450 core
const int kMost = 8;
layout(binding = 0) uniform sampler2D uColour[kMost];
layout(binding = 8) uniform sampler2D uDepth[kMost];
uniform int uCount;
layout(location = 0) out vec4 oColour;

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  vec4 colour[kMost];
  float depth[kMost];
  int count = 0;
  for (int k = 0; k < uCount; ++k) {
    vec4 c = texelFetch(uColour[k], p, 0);
    if (c.a == 0.0) continue;
    float d = texelFetch(uDepth[k], p, 0).r;
    int at = count++;
    for (; at > 0 && depth[at - 1] > d; --at) {
      colour[at] = colour[at - 1];
      depth[at] = depth[at - 1];
    }
    colour[at] = c;
    depth[at] = d;
  }
  if (count == 0) discard;
  vec4 sum = vec4(0.0);
  for (int k = 0; k < count; ++k)
    sum += (1.0 - sum.a) * vec4(colour[k].rgb * colour[k].a, colour[k].a);
  oColour = sum;
}
