#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

#include "slam/depth/surface_nets.h"
#include "slam/depth/surface_point.h"
#include "slam/io/tile_files.h"

namespace orb360 {

struct MeshSummary {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
};

/// Writes the surface through the points of a cloud (ExtractSurface) as binary little-endian PLY:
/// vertices x y z nx ny nz float, red green blue uchar, and triangles, counterclockwise as seen
/// from the cameras. The points are kept in files until then, so that the memory does not grow with
/// the cloud, except for 16 bytes a vertex and 36 a triangle where cubes of 256 cells meet. Throws
/// UserError if the disk fails or there are 2^31 vertices or more.
class MeshWriter {
 public:
  /// The points are kept in a folder `PATH.points` while the object lives. `cell_size`: side of the
  /// cells of the surface, in the unit of the points. `num_threads` changes no byte.
  MeshWriter(const std::filesystem::path& path, double cell_size, const SurfaceNetsOptions& options,
             int num_threads);

  /// Adds points. The mesh depends on their order, but only by rounding.
  void Add(std::span<const SurfacePoint> points);
  /// Writes the file. No points may follow.
  MeshSummary Write() const;

 private:
  /// A SurfacePoint as it is stored.
  struct Record {
    std::array<float, 3> position;
    std::array<float, 3> normal;
    std::array<std::uint8_t, 3> rgb;
    float confidence;
  };

  const std::filesystem::path path_;
  const double cell_size_;
  const SurfaceNetsOptions options_;
  const int num_threads_;
  /// The points of each cube and of the margin around it.
  TileFiles<Record> tiles_;
};

}  // namespace orb360
