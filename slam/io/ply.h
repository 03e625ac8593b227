#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/surface_point.h"
#include "slam/io/atomic_file.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

struct ColoredPoint {
  /// Position, metres.
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  std::array<std::uint8_t, 3> rgb{};
};

/// Writes points as binary little-endian PLY (x y z float, red green blue uchar). Each point is
/// first transformed into the file's world (FileWorldFromMap). Throws UserError if the file cannot
/// be written.
void WritePly(const std::filesystem::path& path, std::span<const ColoredPoint> points,
              const Rigid3& file_world_from_map = {});

/// Reads a file that WritePly wrote. Throws UserError for any other file.
std::vector<ColoredPoint> ReadPly(const std::filesystem::path& path);

/// Writes a cloud of surface points as binary little-endian PLY (x y z nx ny nz float, red green
/// blue uchar, confidence float). Points are written as they are appended, and their number is
/// entered at the end. Throws UserError if the file cannot be written.
class SurfacePlyWriter {
 public:
  /// `voxel_size`, world units, is stated in the header's comment on the confidence.
  SurfacePlyWriter(const std::filesystem::path& path, double voxel_size);

  void Append(std::span<const SurfacePoint> points);
  /// Makes the file appear under its name.
  void Commit();

  std::uint64_t num_points() const { return num_points_; }

 private:
  std::string Header() const;

  const double voxel_size_;
  AtomicFile file_;
  std::uint64_t num_points_ = 0;
};

/// Returns true if the file begins with the header of SurfacePlyWriter.
bool IsSurfacePly(const std::filesystem::path& path);

/// Returns the voxel size, world units, that the header of SurfacePlyWriter states; none for any
/// other file.
std::optional<double> VoxelSizeOf(const std::filesystem::path& path);

/// Reads a file that SurfacePlyWriter wrote. Throws UserError for any other file.
std::vector<SurfacePoint> ReadSurfacePly(const std::filesystem::path& path);

/// Passes on each point of a file that WritePly or SurfacePlyWriter wrote, which may be larger than
/// the memory. Points of WritePly have no normal and the confidence 0. Throws UserError for any
/// other file.
void ReadCloudPoints(const std::filesystem::path& path,
                     const std::function<void(const SurfacePoint&)>& take);

}  // namespace orb360
