#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include <Eigen/Core>

namespace orb360 {

/// Bits of each coordinate in a Morton code, which is the finest division of an octree's cube.
inline constexpr int kMortonBits = 21;

/// Moves bit i of a number below 2^21 to bit 3 i.
inline std::uint64_t SpreadBits(std::uint64_t value) {
  value &= 0x1FFFFF;
  value = (value | value << 32) & 0x1F00000000FFFF;
  value = (value | value << 16) & 0x1F0000FF0000FF;
  value = (value | value << 8) & 0x100F00F00F00F00F;
  value = (value | value << 4) & 0x10C30C30C30C30C3;
  value = (value | value << 2) & 0x1249249249249249;
  return value;
}

/// The inverse of SpreadBits; other bits are ignored.
inline std::uint32_t GatherBits(std::uint64_t value) {
  value &= 0x1249249249249249;
  value = (value | value >> 2) & 0x10C30C30C30C30C3;
  value = (value | value >> 4) & 0x100F00F00F00F00F;
  value = (value | value >> 8) & 0x1F0000FF0000FF;
  value = (value | value >> 16) & 0x1F00000000FFFF;
  value = (value | value >> 32) & 0x1FFFFF;
  return static_cast<std::uint32_t>(value);
}

/// Interleaves the bits of three numbers below 2^21, those of x highest. Codes in ascending order
/// run through the cubes of an octree in depth-first order.
inline std::uint64_t MortonCode(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return SpreadBits(x) << 2 | SpreadBits(y) << 1 | SpreadBits(z);
}

/// Code of the cell of a position in the cube with the corner `min` and the given side, divided
/// into 2^21 cells along each axis. A position outside belongs to the nearest cell.
inline std::uint64_t MortonCode(const Eigen::Vector3d& position, const Eigen::Vector3d& min,
                                double side) {
  constexpr double kCells = 1 << kMortonBits;
  const auto cell = [&](int axis) {
    const double at = (position[axis] - min[axis]) / side * kCells;
    return static_cast<std::uint32_t>(std::clamp(at, 0.0, kCells - 1));
  };
  return MortonCode(cell(0), cell(1), cell(2));
}

/// Number of octal digits, from the highest of 21, in which two codes agree.
inline int CommonDigits(std::uint64_t a, std::uint64_t b) {
  return (std::countl_zero((a ^ b) << 1 | 1)) / 3;
}

}  // namespace orb360
