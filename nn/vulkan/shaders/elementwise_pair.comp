#version 450
#extension GL_GOOGLE_include_directive : require
// Adds or multiplies two tensors element by element.
#include "common.glsl"

layout(constant_id = 2) const int MULTIPLIES = 0;
layout(constant_id = 3) const int A_IS_HALF = 0;
layout(constant_id = 4) const int B_IS_HALF = 0;
layout(constant_id = 5) const int Y_IS_HALF = 0;

layout(push_constant) uniform Parameters {
  View a;
  View b;
  View y;
  int height;
  int width;
};

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.y >= height || at.x >= width) return;
  float first = Load(At(a, at.z, at.y, at.x), A_IS_HALF);
  float second = Load(At(b, at.z, at.y, at.x), B_IS_HALF);
  float value = MULTIPLIES != 0 ? first * second : first + second;
  Store(At(y, at.z, at.y, at.x), Y_IS_HALF, value);
}
