#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/rigid3.h"

namespace orb360 {

struct ColoredPoint {
  /// Metres.
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  std::array<std::uint8_t, 3> rgb{};
};

/// Writes points as binary little-endian PLY (x y z float, red green blue uchar), each moved into
/// the file's world first (FileWorldFromMap). Throws UserError if the file cannot be written.
void WritePly(const std::filesystem::path& path, std::span<const ColoredPoint> points,
              const Rigid3& file_world_from_map = {});

/// The points of a file that WritePly wrote. Throws UserError for any other.
std::vector<ColoredPoint> ReadPly(const std::filesystem::path& path);

}  // namespace orb360
