#version 450
#extension GL_GOOGLE_include_directive : require
// Copies depth and confidence of points, writes 0 elsewhere, and clears the counts.
#include "common.glsl"
#include "median.glsl"

layout(push_constant) uniform Parameters {
  View depth;
  View confidence;
  View x;
  View c;
  int height;
  int width;
  uint scratch;  // counts, prefix and rank
};

void main() {
  uvec2 size = gl_NumWorkGroups.xy * gl_WorkGroupSize.xy;
  for (uint i = gl_GlobalInvocationID.y * size.x + gl_GlobalInvocationID.x; i <= RANK;
       i += size.x * size.y) {
    words[scratch + i] = 0u;
  }
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.y >= height || at.x >= width) return;
  float range = arena[At(depth, 0, at.y, at.x)];
  float trust = arena[At(confidence, 0, at.y, at.x)];
  // Subnormal numbers are points too, which not every device can compare. Comparisons with NaN are
  // false.
  uint bits = floatBitsToUint(range);
  uint trust_bits = floatBitsToUint(trust);
  bool is_point = bits > 0u && bits < 0x7f800000u && trust_bits > 0u && trust_bits <= 0x7f800000u;
  arena[At(x, 0, at.y, at.x)] = is_point ? range : 0.0;
  arena[At(c, 0, at.y, at.x)] = is_point ? min(trust, 1.0) : 0.0;
}
