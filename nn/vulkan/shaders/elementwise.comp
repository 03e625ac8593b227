#version 450
#extension GL_GOOGLE_include_directive : require
// A function of each element.
#include "common.glsl"
#include "math.glsl"

layout(constant_id = 2) const int FUNCTION = 0;  // vulkan::ElementFunction
layout(constant_id = 3) const int X_IS_HALF = 0;
layout(constant_id = 4) const int Y_IS_HALF = 0;

layout(push_constant) uniform Parameters {
  View x;
  View y;
  int height;
  int width;
  float a;  // slope, minimum or scale
  float b;  // maximum or offset
};

float Apply(float value) {
  switch (FUNCTION) {
    case 0:  // copy
      return value;
    case 1:  // leaky ReLU, and with a = 0 ReLU; NaN fails the comparison
      return value <= 0.0 ? (a == 0.0 ? 0.0 : a * value) : value;
    case 2:
      return Tanh(value);
    case 3:
      return Sigmoid(value);
    case 4:
      return Softplus(value);
    case 5:
      return Exp(value);
    case 6:
      return Log(value);
    case 7:  // clamp; NaN fails both comparisons
      return value < a ? a : value > b ? b : value;
    default:
      return a * value + b;
  }
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.y >= height || at.x >= width) return;
  float value = Load(At(x, at.z, at.y, at.x), X_IS_HALF);
  Store(At(y, at.z, at.y, at.x), Y_IS_HALF, Apply(value));
}
