#include <algorithm>
#include <string>

#include "nn/base/cpu.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/precision.h>

namespace orb360::nn {

MatrixUnits FindMatrixUnits() {
  const BFloat16Unit unit = BestBFloat16Unit();
  return {.amx = unit == BFloat16Unit::kAmx,
          .avx512_bfloat16 = unit != BFloat16Unit::kNone,
          .avx512_vnni = FindByteUnit() == ByteUnit::kVnni,
          .arm_dot_product = FindByteUnit() == ByteUnit::kDotProduct};
}

DataType ChoosePrecision(Precision wanted, const Graph& graph, const MatrixUnits& units) {
  const bool has_ranges = std::ranges::any_of(
      graph.nodes, [](const Node& node) { return node.input_range.has_value(); });
  const bool has_byte_unit = units.avx512_vnni || units.arm_dot_product;
  switch (wanted) {
    case Precision::kFloat:
      return DataType::kFloat;
    case Precision::kBFloat16:
      if (units.amx || units.avx512_bfloat16) return DataType::kBFloat16;
      throw UserError("this processor has neither AVX-512 BF16 nor AMX; compute with 32 bits");
    case Precision::kInt8:
      if (!has_byte_unit) {
        throw UserError(
            "this processor has neither AVX-512 VNNI nor Arm's dot product; compute with 32 bits");
      }
      if (has_ranges) return DataType::kInt8;
      throw UserError("network \"" + graph.name +
                      "\" has no ranges of inputs for 8 bits; add them with `python3 -m "
                      "weights_tools.quantize`, or compute with 32 bits");
    case Precision::kAuto:
      break;
  }
  // VDPBF16PS without AMX is not faster than floats: it has half of the products of floats per
  // layer, and tiles of floats have a quarter.
  if (units.amx) return DataType::kBFloat16;
  return has_byte_unit && has_ranges ? DataType::kInt8 : DataType::kFloat;
}

const char* NameOf(DataType type) {
  switch (type) {
    case DataType::kFloat:
      return "float";
    case DataType::kBFloat16:
      return "bfloat16";
    case DataType::kFloat16:
      return "float16";
    case DataType::kInt8:
      return "int8";
  }
  return "";
}

}  // namespace orb360::nn
