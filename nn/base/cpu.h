#pragma once

#include <cstdint>

namespace orb360::nn {

/// Units that multiply bfloat16 numbers and add them up as floats, the best one last. Highway does
/// not dispatch to these.
enum class BFloat16Unit : std::uint8_t {
  kNone,
  /// AVX-512's VDPBF16PS: Intel since Cooper Lake, AMD since Zen 4.
  kAvx512,
  /// AMX's tiles, TDPBF16PS: Intel since Sapphire Rapids.
  kAmx,
};

/// Returns the best unit that this processor has and that the operating system allows.
BFloat16Unit BestBFloat16Unit();

/// Units that multiply bytes and add them up as integers. A processor has at most one.
enum class ByteUnit : std::uint8_t {
  kNone,
  /// AVX-512's VPDPBUSD: Intel since Cascade Lake, AMD since Zen 4.
  kVnni,
  /// Arm's SDOT of 128 bits: most cores since Cortex-A75 and Neoverse N1, Apple's since A13 and M1.
  kDotProduct,
};

/// Returns the unit that this processor has and that the operating system allows.
ByteUnit FindByteUnit();

}  // namespace orb360::nn
