#pragma once

#include <bit>
#include <cstdint>

namespace orb360::nn {

/// The upper half of a float: the same range with 8 bits of precision.
struct BFloat16 {
  std::uint16_t bits = 0;
};

inline float ToFloat(float value) { return value; }
inline float ToFloat(BFloat16 value) {
  return std::bit_cast<float>(std::uint32_t{value.bits} << 16);
}

/// Rounds to nearest, ties to even. NaN becomes a quiet NaN.
inline BFloat16 ToBFloat16(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const bool is_nan = (bits & 0x7fffffffu) > 0x7f800000u;
  // Rounding a NaN could carry into its exponent.
  const std::uint32_t rounded = is_nan ? bits | 0x400000u : bits + 0x7fffu + ((bits >> 16) & 1);
  return {static_cast<std::uint16_t>(rounded >> 16)};
}

}  // namespace orb360::nn
