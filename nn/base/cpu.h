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

/// Returns whether this processor has AVX-512's VPDPBUSD, which adds products of bytes up as
/// integers (Intel since Cascade Lake, AMD since Zen 4), and the operating system allows it.
bool HasVnni();

}  // namespace orb360::nn
