// SPDX-License-Identifier: MIT
// Every mesh: world position to clip space, cut by up to three planes.
// uViewProj      mat4  clip from world (metres)
// uClip[3]       vec4  kept where dot(xyz, p) + w >= 0 (unit normal, metres); (0,0,0,1) = off
#version 450 core
layout(location = 0) in vec3 aPosition;  // world, metres
layout(location = 1) in vec3 aNormal;    // world, unit
layout(location = 2) in vec3 aRest;      // material-fixed position, metres
uniform mat4 uViewProj;
uniform vec4 uClip[3];
out vec3 vPosition;
out vec3 vNormal;
out vec3 vRest;
out float gl_ClipDistance[3];

void main() {
  vPosition = aPosition;
  vNormal = aNormal;
  vRest = aRest;
  for (int i = 0; i < 3; ++i)
    gl_ClipDistance[i] = dot(uClip[i].xyz, aPosition) + uClip[i].w;
  gl_Position = uViewProj * vec4(aPosition, 1.0);
}
