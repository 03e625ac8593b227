#version 450
#extension GL_GOOGLE_include_directive : require
// The mean of each channel by one workgroup: LANES sums over every LANES-th pixel, then a tree.
// LANES is fixed, so that the order of the sum is too. The sums are Kahan's, because those of large
// images have many thousands of terms.
#include "common.glsl"

const int LANES = 128;

layout(push_constant) uniform Parameters {
  View x;
  View y;
  int height;  // of x
  int width;
};

shared float sums[LANES];

void main() {
  int lane = int(gl_LocalInvocationIndex);
  int channel = int(gl_WorkGroupID.z);
  int pixels = height * width;
  precise float sum = 0.0;
  precise float excess = 0.0;  // by which the sum is too large
  for (int i = lane; i < pixels; i += LANES) {
    precise float term = arena[At(x, channel, i / width, i % width)] - excess;
    precise float next = sum + term;
    excess = isinf(next) ? 0.0 : (next - sum) - term;  // Infinity must not become NaN.
    sum = next;
  }
  sums[lane] = sum;
  for (int half_count = LANES / 2; half_count > 0; half_count /= 2) {
    barrier();
    if (lane < half_count) sums[lane] += sums[lane + half_count];
  }
  if (lane == 0) arena[At(y, channel, 0, 0)] = sums[0] / float(pixels);
}
