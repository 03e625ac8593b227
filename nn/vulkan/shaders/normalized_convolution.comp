#version 450
#extension GL_GOOGLE_include_directive : require
// Normalized convolution (nn/kernels/normalized_convolution.h): N = sum w x c, D = sum w c,
// y = N / (D + 1e-20) + bias, c' = D / sum w. An invocation computes one pixel of four output
// channels; the products x c and the confidences of the tile pass through shared memory.
#include "common.glsl"
#include "padding.glsl"

layout(constant_id = 3) const int KERNEL = 3;

layout(push_constant) uniform Parameters {
  View x;
  View c;
  View y;
  View y_confidence;
  int in_channels;
  int height;
  int width;
  int out_channels;
  uint weight;  // in vectors: [group][input][row][column], then [group][bias, 1 / sum w]
};

const int GROUP_WIDTH = int(gl_WorkGroupSize.x);
const int GROUP_HEIGHT = int(gl_WorkGroupSize.y);
const int IN_WIDTH = GROUP_WIDTH + KERNEL - 1;
const int IN_PIXELS = IN_WIDTH * (GROUP_HEIGHT + KERNEL - 1);
shared vec2 tile[IN_PIXELS];  // x c, c

void main() {
  ivec2 lane = ivec2(gl_LocalInvocationID.xy);
  ivec2 first_pixel = ivec2(gl_WorkGroupID.xy) * ivec2(GROUP_WIDTH, GROUP_HEIGHT);
  ivec2 corner = first_pixel - KERNEL / 2;
  int group = int(gl_WorkGroupID.z);
  vec4 numerator = vec4(0.0);
  vec4 denominator = vec4(0.0);
  uint next = weight + uint(group * in_channels * KERNEL * KERNEL);
  for (int channel = 0; channel < in_channels; ++channel) {
    barrier();
    for (int i = int(gl_LocalInvocationIndex); i < IN_PIXELS; i += GROUP_WIDTH * GROUP_HEIGHT) {
      ivec2 from = Source(corner.y + i / IN_WIDTH, corner.x + i % IN_WIDTH, height, width);
      vec2 value = vec2(0.0);
      if (from.x >= 0) {
        float confidence = arena[At(c, channel, from.x, from.y)];
        value = vec2(arena[At(x, channel, from.x, from.y)] * confidence, confidence);
      }
      tile[i] = value;
    }
    barrier();
    for (int row = 0; row < KERNEL; ++row) {
      for (int column = 0; column < KERNEL; ++column) {
        vec2 value = tile[(lane.y + row) * IN_WIDTH + lane.x + column];
        vec4 weights = vectors[next++];
        numerator += weights * value.x;
        denominator += weights * value.y;
      }
    }
  }
  int v = first_pixel.y + lane.y;
  int u = first_pixel.x + lane.x;
  if (v >= height || u >= width) return;
  uint groups = gl_NumWorkGroups.z;
  uint last = weight + groups * uint(in_channels * KERNEL * KERNEL) + uint(2 * group);
  vec4 value = numerator / (denominator + 1e-20) + vectors[last];
  vec4 confidence = denominator * vectors[last + 1u];
  for (int k = 0; k < 4; ++k) {
    int channel = 4 * group + k;
    if (channel >= out_channels) break;
    arena[At(y, channel, v, u)] = value[k];
    arena[At(y_confidence, channel, v, u)] = confidence[k];
  }
}
