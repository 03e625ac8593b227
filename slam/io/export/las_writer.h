#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slam/io/chunked_file.h"

namespace orb360 {

/// What a LAS file says before its points.
struct LasDescription {
  std::uint64_t num_points = 0;
  Eigen::AlignedBox3d bounds;  ///< Of all points, in the file's coordinates.
  std::string wkt;             ///< Coordinate reference system, OGC WKT 1; empty: none.
  bool has_confidence = false;
};

/// How the coordinates of a LAS file are stored: each is the integer (coordinate - offset) / scale,
/// rounded.
struct LasQuantization {
  double scale = 1e-3;     ///< Of all three axes, a power of ten.
  Eigen::Vector3d offset;  ///< Integers.
};

/// Returns steps of 1e-3 units, or finer ones where the largest extent of the bounds has fewer than
/// 10,000 steps, or coarser ones where 32 bits do not hold the extent. Contract: the bounds are not
/// empty, and finite.
LasQuantization QuantizationOf(const Eigen::AlignedBox3d& bounds);

/// Writes a LAS 1.4 file of point data record format 7 (ASPRS LAS specification 1.4 R15): position
/// and 16-bit colour, and the confidence as "extra bytes" (float). What a camera does not measure
/// is 0: intensity, time, angle. The date is 0 as well, so that one run gives the same bytes at any
/// time. Points are written as they are appended. Throws UserError if the file cannot be written.
class LasWriter {
 public:
  LasWriter(const std::filesystem::path& path, const LasDescription& description);

  /// Appends a point. Contract: it lies in the bounds, and `confidence` is given where the
  /// description says so.
  void Append(const Eigen::Vector3d& position, const std::array<std::uint8_t, 3>& rgb,
              float confidence);
  /// Makes the file appear under its name. Contract: all points were appended.
  void Commit();

 private:
  void WriteHeader(const LasDescription& description, std::uint32_t point_offset);

  const LasQuantization quantization_;
  const bool has_confidence_;
  std::uint64_t num_missing_;  // points that have not been appended yet
  ChunkedFile file_;
};

}  // namespace orb360
