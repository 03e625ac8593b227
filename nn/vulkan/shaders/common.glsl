// What all shaders share: the two buffers, and how tensors lie in the first one.
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_spirv_intrinsics : require
#ifdef HAS_HALVES
#extension GL_EXT_shader_16bit_storage : require
#endif

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

// Tensors of a program with 16-bit storage may be halves; the constants of a shader say which ones.
// Everything is computed in 32 bits. What is too large for a half becomes the largest one.
#ifdef HAS_HALVES
layout(std430, set = 0, binding = 0) buffer Halves { float16_t halves[]; };

float Load(uint at, int is_half) { return is_half != 0 ? float(halves[at]) : arena[at]; }

void Store(uint at, int is_half, float value) {
  if (is_half != 0) {
    const float largest = 65504.0;
    if (abs(value) > largest && !isinf(value)) value = value < 0.0 ? -largest : largest;
    halves[at] = float16_t(value);
  } else {
    arena[at] = value;
  }
}
#else
float Load(uint at, int is_half) { return arena[at]; }
void Store(uint at, int is_half, float value) { arena[at] = value; }
#endif

bool IsNan(float x) { return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u; }
