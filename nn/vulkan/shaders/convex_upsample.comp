#version 450
#extension GL_GOOGLE_include_directive : require
// Multiplies height and width by a factor f of 1 or 2: output pixel (fv + i, fu + j) is the sum of the
// 3 x 3 neighbours of (v, u), row by row, weighted by the softmax of channels 9 (fi + j) ... + 8 of
// `weights`.
#include "common.glsl"
#include "math.glsl"
#include "padding.glsl"

layout(constant_id = 3) const int FACTOR = 2;

layout(push_constant) uniform Parameters {
  View x;
  View weights;
  View y;
  int height;  // of x
  int width;
};

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.y >= height || at.x >= width) return;
  float neighbours[9];
  for (int k = 0; k < 9; ++k) {
    ivec2 from = Source(at.y + k / 3 - 1, at.x + k % 3 - 1, height, width);
    neighbours[k] = from.x < 0 ? 0.0 : arena[At(x, 0, from.x, from.y)];
  }
  [[unroll]] for (int part = 0; part < FACTOR * FACTOR; ++part) {
    float logits[9];
    for (int k = 0; k < 9; ++k) logits[k] = arena[At(weights, 9 * part + k, at.y, at.x)];
    float largest = logits[0];
    for (int k = 1; k < 9; ++k) largest = max(largest, logits[k]);
    float sum = 0.0;
    float value = 0.0;
    for (int k = 0; k < 9; ++k) {
      float fraction = IsNan(logits[k]) ? logits[k] : Exp(logits[k] - largest);
      sum += fraction;
      value += fraction * neighbours[k];
    }
    arena[At(y, 0, FACTOR * at.y + part / FACTOR, FACTOR * at.x + part % FACTOR)] = value / sum;
  }
}
