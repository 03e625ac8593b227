#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include <Eigen/Geometry>

namespace orb360 {

/// Appends numbers, with `separator` before each, as the shortest text that reads back to the same.
void AppendNumbers(std::span<const double> numbers, char separator, std::string* text);

inline void AppendNumbers(const Eigen::Vector3d& numbers, char separator, std::string* text) {
  AppendNumbers(std::span(numbers.data(), 3), separator, text);
}

void AppendInteger(std::uint64_t number, char separator, std::string* text);

/// Returns the quaternion of the same rotation with w >= 0, in the order w, x, y, z.
inline std::array<double, 4> ScalarFirst(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;
  return {sign * rotation.w(), sign * rotation.x(), sign * rotation.y(), sign * rotation.z()};
}

}  // namespace orb360
