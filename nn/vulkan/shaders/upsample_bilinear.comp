#version 450
#extension GL_GOOGLE_include_directive : require
// Doubles height and width: output pixel u samples the input, linearly in both directions, at
// (u + 0.5) / 2 - 0.5: a quarter of a pixel from the input pixel that contains it.
#include "common.glsl"
#include "padding.glsl"

layout(push_constant) uniform Parameters {
  View x;
  View y;
  int height;  // of x
  int width;
};

float Pixel(int channel, int v, int u) {
  ivec2 from = Source(v, u, height, width);
  return from.x < 0 ? 0.0 : arena[At(x, channel, from.x, from.y)];
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.y >= 2 * height || at.x >= 2 * width) return;
  ivec2 near = at.xy / 2;
  ivec2 far = near + (at.xy % 2) * 2 - 1;
  float left = 0.75 * Pixel(at.z, near.y, near.x) + 0.25 * Pixel(at.z, far.y, near.x);
  float right = 0.75 * Pixel(at.z, near.y, far.x) + 0.25 * Pixel(at.z, far.y, far.x);
  arena[At(y, at.z, at.y, at.x)] = 0.75 * left + 0.25 * right;
}
