#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/surface_point.h"
#include "slam/geometry/rigid3.h"
#include "slam/io/atomic_file.h"

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

/// A cloud of surface points as binary little-endian PLY (x y z nx ny nz float, red green blue
/// uchar, confidence float), written as the points come: their number is entered at the end. Throws
/// UserError if the file cannot be written.
class SurfacePlyWriter {
 public:
  /// `voxel_size`, world units, for the file's comment on what the confidence means.
  SurfacePlyWriter(const std::filesystem::path& path, double voxel_size);

  void Append(std::span<const SurfacePoint> points);
  /// The file appears under its name.
  void Commit();

  std::uint64_t num_points() const { return num_points_; }

 private:
  std::string Header() const;

  const double voxel_size_;
  AtomicFile file_;
  std::uint64_t num_points_ = 0;
};

/// True where the file begins as those of SurfacePlyWriter do.
bool IsSurfacePly(const std::filesystem::path& path);

/// The points of a file that SurfacePlyWriter wrote. Throws UserError for any other.
std::vector<SurfacePoint> ReadSurfacePly(const std::filesystem::path& path);

}  // namespace orb360
