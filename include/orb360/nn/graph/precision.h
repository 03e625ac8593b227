#pragma once

#include <cstdint>

#include <orb360/nn/graph/graph.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// In which type the convolutions of a network are to multiply on the CPU.
enum class Precision : std::uint8_t {
  kAuto,      ///< As ChoosePrecision decides from the processor and the network.
  kFloat,     ///< In floats, on every processor.
  kBFloat16,  ///< In bfloat16, where a layer allows it.
  kInt8,      ///< In 8-bit integers, the convolutions whose input has a range in the file.
};

/// What a processor has that multiplies in short types.
struct MatrixUnits {
  bool amx = false;              ///< AMX's tiles of bfloat16.
  bool avx512_bfloat16 = false;  ///< AVX-512's products of bfloat16.
  bool avx512_vnni = false;      ///< AVX-512's products of bytes.
  bool arm_dot_product = false;  ///< Arm's products of bytes.
};

/// Returns what this processor has and the operating system allows.
MatrixUnits FindMatrixUnits();

/// Returns the type for ExecutorOptions::precision. kAuto becomes the fastest type in which the
/// network is as accurate as in floats: bfloat16 with AMX; 8 bits with AVX-512 VNNI or
/// Arm's dot product where the network has ranges of inputs; floats elsewhere. It depends on
/// nothing else, never on measured times, because the type decides the bytes of results. Throws
/// UserError where the processor or the network does not allow the type that is named.
DataType ChoosePrecision(Precision wanted, const Graph& graph,
                         const MatrixUnits& units = FindMatrixUnits());

/// Returns "float", "bfloat16", "float16" or "int8".
const char* NameOf(DataType type);

}  // namespace orb360::nn
