#version 450
#extension GL_GOOGLE_include_directive : require
// y = activation(convolution(x) + bias + residual). A workgroup computes a tile of pixels of
// 4 VECTORS output channels. Each invocation keeps COLUMNS pixels of them in registers, and the
// input of the tile passes through shared memory, CHUNK channels at a time. A sum runs over input
// channel, row and column of the kernel in this order, whatever the tile is.
#include "common.glsl"
#include "padding.glsl"

layout(constant_id = 3) const int KERNEL = 3;
layout(constant_id = 4) const int STRIDE = 1;
layout(constant_id = 5) const int COLUMNS = 1;
layout(constant_id = 6) const int VECTORS = 1;
layout(constant_id = 7) const int CHUNK = 1;
layout(constant_id = 8) const int HAS_RESIDUAL = 0;
layout(constant_id = 9) const int X_IS_HALF = 0;
layout(constant_id = 10) const int RESIDUAL_IS_HALF = 0;
layout(constant_id = 11) const int Y_IS_HALF = 0;

layout(push_constant) uniform Parameters {
  View x;
  View residual;
  View y;
  int in_channels;
  int in_height;
  int in_width;
  int out_channels;
  int out_height;
  int out_width;
  uint weight;  // in vectors: [group][input][row][column][vector], then [vector] of biases
  float slope;
};

const int GROUP_WIDTH = int(gl_WorkGroupSize.x);
const int GROUP_HEIGHT = int(gl_WorkGroupSize.y);
const int IN_WIDTH = (GROUP_WIDTH * COLUMNS - 1) * STRIDE + KERNEL;
const int IN_HEIGHT = (GROUP_HEIGHT - 1) * STRIDE + KERNEL;
const int IN_PIXELS = IN_WIDTH * IN_HEIGHT;
shared float tile[CHUNK * IN_PIXELS];

void LoadTile(int first, ivec2 corner) {
  for (int i = int(gl_LocalInvocationIndex); i < CHUNK * IN_PIXELS;
       i += GROUP_WIDTH * GROUP_HEIGHT) {
    int channel = first + i / IN_PIXELS;
    int pixel = i % IN_PIXELS;
    float value = 0.0;
    if (channel < in_channels) {
      ivec2 from = Source(corner.y + pixel / IN_WIDTH, corner.x + pixel % IN_WIDTH, in_height,
                          in_width);
      if (from.x >= 0) value = Load(At(x, channel, from.x, from.y), X_IS_HALF);
    }
    tile[i] = value;
  }
}

void main() {
  ivec2 lane = ivec2(gl_LocalInvocationID.xy);
  ivec2 first_pixel = ivec2(gl_WorkGroupID.xy) * ivec2(GROUP_WIDTH * COLUMNS, GROUP_HEIGHT);
  ivec2 corner = first_pixel * STRIDE - KERNEL / 2;
  int group = int(gl_WorkGroupID.z);

  vec4 sums[COLUMNS * VECTORS];
  // Sums stay in registers only where the loops over them are unrolled.
  [[unroll]] for (int i = 0; i < COLUMNS * VECTORS; ++i) sums[i] = vec4(0.0);
  uint next = weight + uint(group * in_channels * KERNEL * KERNEL * VECTORS);
  for (int first = 0; first < in_channels; first += CHUNK) {
    barrier();
    LoadTile(first, corner);
    barrier();
    int count = min(CHUNK, in_channels - first);
    for (int channel = 0; channel < count; ++channel) {
      for (int row = 0; row < KERNEL; ++row) {
        int from = channel * IN_PIXELS + (lane.y * STRIDE + row) * IN_WIDTH + lane.x * STRIDE;
        [[unroll]] for (int column = 0; column < KERNEL; ++column) {
          vec4 weights[VECTORS];
          [[unroll]] for (int i = 0; i < VECTORS; ++i) weights[i] = vectors[next + uint(i)];
          next += uint(VECTORS);
          [[unroll]] for (int i = 0; i < COLUMNS; ++i) {
            float value = tile[from + column + i * GROUP_WIDTH * STRIDE];
            [[unroll]] for (int j = 0; j < VECTORS; ++j) {
              sums[i * VECTORS + j] += weights[j] * value;
            }
          }
        }
      }
    }
  }

  int groups = int(gl_NumWorkGroups.z);
  uint bias = weight + uint(groups * in_channels * KERNEL * KERNEL * VECTORS + group * VECTORS);
  int v = first_pixel.y + lane.y;
  if (v >= out_height) return;
  [[unroll]] for (int i = 0; i < COLUMNS; ++i) {
    int u = first_pixel.x + lane.x + i * GROUP_WIDTH;
    if (u >= out_width) continue;
    [[unroll]] for (int j = 0; j < VECTORS; ++j) {
      vec4 result = sums[i * VECTORS + j] + vectors[bias + uint(j)];
      [[unroll]] for (int k = 0; k < 4; ++k) {
        int channel = (group * VECTORS + j) * 4 + k;
        if (channel >= out_channels) continue;
        float value = result[k];
        if (HAS_RESIDUAL != 0) value += Load(At(residual, channel, v, u), RESIDUAL_IS_HALF);
        // NaN fails both comparisons and stays NaN.
        if (value <= 0.0) value = slope == 0.0 ? 0.0 : value * slope;
        Store(At(y, channel, v, u), Y_IS_HALF, value);
      }
    }
  }
}
