// What all shaders share: the two buffers, and how tensors lie in the first one.
#extension GL_EXT_spirv_intrinsics : require

// NaN and infinity are kept (SPV_KHR_float_controls, SignedZeroInfNanPreserve of 32 bits).
spirv_execution_mode(extensions = ["SPV_KHR_float_controls"], capabilities = [4466], 4461, 32);

layout(local_size_x_id = 0, local_size_y_id = 1) in;

// Tensors and scratch of one run; their places follow from the memory plan.
layout(std430, set = 0, binding = 0) buffer Arena { float arena[]; };
layout(std430, set = 0, binding = 0) buffer Words { uint words[]; };
// Weights in the order in which the shaders read them.
layout(std430, set = 0, binding = 1) readonly buffer Constants { float constants[]; };
layout(std430, set = 0, binding = 1) readonly buffer Vectors { vec4 vectors[]; };

// Planes of floats: position of the first element, and distances from row to row and from channel
// to channel, in elements.
struct View {
  uint offset;
  uint row;
  uint plane;
};

uint At(View view, int channel, int y, int x) {
  return view.offset + uint(channel) * view.plane + uint(y) * view.row + uint(x);
}

bool IsNan(float x) { return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u; }
