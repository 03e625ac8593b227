#version 450
#extension GL_GOOGLE_include_directive : require
// Multiplications with additions that wait for nothing but their own last result, to measure how
// many a device can do (peaks.h): 64 in each repetition of each invocation.
#include "common.glsl"

layout(push_constant) uniform Parameters {
  uint y;
  int repetitions;
  float factor;
  float addend;
};

void main() {
  vec4 sums[16];
  [[unroll]] for (int i = 0; i < 16; ++i) {
    sums[i] = vec4(gl_GlobalInvocationID.x + i) + vec4(0.0, 0.25, 0.5, 0.75);
  }
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    [[unroll]] for (int i = 0; i < 16; ++i) sums[i] = fma(sums[i], vec4(factor), vec4(addend));
  }
  vec4 sum = vec4(0.0);
  [[unroll]] for (int i = 0; i < 16; ++i) sum += sums[i];
  // Never so, but the compiler does not know.
  if (sum.x + sum.y + sum.z + sum.w == -1.0) arena[y] = sum.x;
}
