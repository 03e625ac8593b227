#version 450
#extension GL_GOOGLE_include_directive : require
// x = ln(depth / median) of points, and the median, which is 1 where there are no points.
#include "common.glsl"
#include "math.glsl"
#include "median.glsl"

layout(push_constant) uniform Parameters {
  View x;
  View median;
  int height;
  int width;
  uint scratch;
};

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  uint bits = words[scratch + PREFIX];
  if (bits == 0u) bits = 0x3f800000u;
  if (at == ivec2(0)) words[median.offset] = bits;
  if (at.y >= height || at.x >= width) return;
  uint value = words[At(x, 0, at.y, at.x)];
  if (value != 0u) words[At(x, 0, at.y, at.x)] = floatBitsToUint(LogOfRatio(value, bits));
}
