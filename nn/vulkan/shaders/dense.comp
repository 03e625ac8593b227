#version 450
#extension GL_GOOGLE_include_directive : require
// y = W x + bias of tensors of 1 x 1 pixels. An invocation computes one output.
#include "common.glsl"

layout(push_constant) uniform Parameters {
  View x;
  View y;
  int inputs;
  int outputs;
  uint weight;  // [input][output], then [output] of biases
};

void main() {
  int o = int(gl_GlobalInvocationID.x);
  if (o >= outputs) return;
  float sum = constants[weight + uint(inputs * outputs + o)];
  for (int i = 0; i < inputs; ++i) {
    sum += constants[weight + uint(i * outputs + o)] * arena[x.offset + uint(i) * x.plane];
  }
  arena[y.offset + uint(o) * y.plane] = sum;
}
