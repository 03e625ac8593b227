#version 450
#extension GL_GOOGLE_include_directive : require
// Doubles height and width: output pixel u samples the input, linearly in both directions, at
// (u + 0.5) / 2 - 0.5: a quarter of a pixel from the input pixel that contains it.
#include "common.glsl"
#include "padding.glsl"

layout(constant_id = 3) const int X_IS_HALF = 0;
layout(constant_id = 4) const int Y_IS_HALF = 0;

layout(push_constant) uniform Parameters {
  View x;
  View y;
  int height;  // of x
  int width;
};

float Pixel(int channel, int v, int u) {
  ivec2 from = Source(v, u, height, width);
  return from.x < 0 ? 0.0 : Load(At(x, channel, from.x, from.y), X_IS_HALF);
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.y >= 2 * height || at.x >= 2 * width) return;
  ivec2 near = at.xy / 2;
  ivec2 far = near + (at.xy % 2) * 2 - 1;
  float left = 0.75 * Pixel(at.z, near.y, near.x) + 0.25 * Pixel(at.z, far.y, near.x);
  float right = 0.75 * Pixel(at.z, near.y, far.x) + 0.25 * Pixel(at.z, far.y, far.x);
  Store(At(y, at.z, at.y, at.x), Y_IS_HALF, 0.75 * left + 0.25 * right);
}
