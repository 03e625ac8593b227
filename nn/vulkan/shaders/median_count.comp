#version 450
#extension GL_GOOGLE_include_directive : require
// Counts the points whose bits above `shift + bits` are the prefix, by the value of the `bits`
// below.
#include "common.glsl"
#include "median.glsl"

layout(push_constant) uniform Parameters {
  View x;
  int height;
  int width;
  uint scratch;
  uint pass;
  uint shift;
  uint bits;
};

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.y >= height || at.x >= width) return;
  uint value = words[At(x, 0, at.y, at.x)];
  if (value == 0u) return;
  // The first digit has no bits above it.
  if (pass > 0u && value >> (shift + bits) != words[scratch + PREFIX]) return;
  uint digit = (value >> shift) & ((1u << bits) - 1u);
  atomicAdd(words[scratch + pass * BINS + digit], 1u);
}
