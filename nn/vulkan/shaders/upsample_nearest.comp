#version 450
#extension GL_GOOGLE_include_directive : require
// Doubles height and width by repeating pixels.
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
  Store(At(y, at.z, at.y, at.x), Y_IS_HALF, Load(At(x, at.z, at.y / 2, at.x / 2), X_IS_HALF));
}
