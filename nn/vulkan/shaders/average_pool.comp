#version 450
#extension GL_GOOGLE_include_directive : require
// Halves height and width: the mean of each 2 x 2 square.
#include "common.glsl"

layout(constant_id = 2) const int X_IS_HALF = 0;
layout(constant_id = 3) const int Y_IS_HALF = 0;

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
  float upper = Load(first, X_IS_HALF) + Load(first + 1u, X_IS_HALF);
  float lower = Load(first + x.row, X_IS_HALF) + Load(first + x.row + 1u, X_IS_HALF);
  Store(At(y, at.z, at.y, at.x), Y_IS_HALF, 0.25 * (upper + lower));
}
