#version 450
#extension GL_GOOGLE_include_directive : require
// Finds the digit of the lower median in the counts of one pass. One workgroup.
#include "common.glsl"
#include "median.glsl"

layout(push_constant) uniform Parameters {
  uint scratch;
  uint pass;
  uint bits;
};

const uint LANES = 128u;
const uint BINS_OF_LANE = BINS / LANES;
shared uint sums[LANES];

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint first = scratch + pass * BINS + lane * BINS_OF_LANE;
  uint sum = 0u;
  for (uint i = 0u; i < BINS_OF_LANE; ++i) sum += words[first + i];
  sums[lane] = sum;
  barrier();
  if (lane != 0u) return;
  uint points = 0u;
  for (uint i = 0u; i < LANES; ++i) points += sums[i];
  if (points == 0u) return;  // there are none at all, and the prefix stays 0
  uint rank = pass == 0u ? (points - 1u) / 2u : words[scratch + RANK];
  uint chosen = 0u;
  while (chosen < LANES - 1u && rank >= sums[chosen]) rank -= sums[chosen++];
  uint digit = chosen * BINS_OF_LANE;
  uint start = scratch + pass * BINS;
  while (digit < BINS - 1u && rank >= words[start + digit]) rank -= words[start + digit++];
  words[scratch + PREFIX] = words[scratch + PREFIX] << bits | digit;
  words[scratch + RANK] = rank;
}
