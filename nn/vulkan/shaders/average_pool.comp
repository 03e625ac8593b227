#version 450
#extension GL_GOOGLE_include_directive : require
// Halves height and width: the mean of each 2 x 2 square.
#include "common.glsl"

layout(push_constant) uniform Parameters {
  View x;
  View y;
  int height;  // of y
  int width;
};

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.y >= height || at.x >= width) return;
  uint first = At(x, at.z, 2 * at.y, 2 * at.x);
  float upper = arena[first] + arena[first + 1u];
  float lower = arena[first + x.row] + arena[first + x.row + 1u];
  arena[At(y, at.z, at.y, at.x)] = 0.25 * (upper + lower);
}
