#version 450
#extension GL_GOOGLE_include_directive : require
// Adds or multiplies two tensors element by element.
#include "common.glsl"

layout(constant_id = 2) const int MULTIPLIES = 0;

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
  float first = arena[At(a, at.z, at.y, at.x)];
  float second = arena[At(b, at.z, at.y, at.x)];
  arena[At(y, at.z, at.y, at.x)] = MULTIPLIES != 0 ? first * second : first + second;
}
