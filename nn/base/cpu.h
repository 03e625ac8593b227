#pragma once

#include <cstdint>

namespace orb360::nn {

/// What multiplies bfloat16 numbers and adds them up as floats, best last. Highway does not
/// dispatch to these.
enum class BFloat16Unit : std::uint8_t {
  kNone,
  /// AVX-512's VDPBF16PS: Intel since Cooper Lake, AMD since Zen 4.
  kAvx512,
  /// AMX's tiles, TDPBF16PS: Intel since Sapphire Rapids.
  kAmx,
};

/// The best that this processor has and this operating system lets us use.
BFloat16Unit BestBFloat16Unit();

}  // namespace orb360::nn
