#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/surface_point.h"

namespace orb360 {

/// What fell into one cube of a grid: sums from which its point is made, so that parts of the same
/// voxel can be added later.
struct Voxel {
  std::uint64_t key = 0;          // VoxelKey; 0 is none
  float information = 0;          // sum of 1 / variance, in voxels; the weight of everything below
  float best = 0;                 // largest of them
  std::array<float, 3> offset{};  // from the cube's centre, in its size
  std::array<float, 3> normal{};
  std::array<float, 3> rgb{};  // 0..255
  std::int32_t last_view = 0;  // the newest that added to it

  Voxel& operator+=(const Voxel& other);
};

/// A point that falls into a grid.
struct VoxelSample {
  Eigen::Vector3d position;  // world
  Eigen::Vector3f normal;
  std::array<std::uint8_t, 3> rgb;
  float error;  // to be expected, world units
};

/// Cubes of one size in the world, filled with points one keyframe after the other.
class VoxelGrid {
 public:
  explicit VoxelGrid(double size) : size_(size) {}

  /// Adds what a keyframe sees. Points more than 2^20 voxels from the origin are left out.
  void Add(std::span<const VoxelSample> samples, int view);

  size_t num_voxels() const { return count_; }

  /// Takes out the half that has gone without a new point the longest, or everything; ordered by
  /// key.
  std::vector<Voxel> TakeOldest();
  std::vector<Voxel> TakeAll();

 private:
  std::vector<Voxel> Take(int last_view);
  /// The place of a key's voxel, or where it would be put.
  Voxel& Find(std::uint64_t key);
  /// Makes room for so many new voxels.
  void Reserve(size_t more);
  void Rebuild(std::span<const Voxel> voxels, size_t capacity);

  const double size_;
  std::vector<Voxel> slots_;  // open addressing, a power of two
  size_t count_ = 0;
};

/// Side of the cubes of voxels that VoxelTile tells apart, in voxels.
inline constexpr int kTileVoxels = 256;

/// A number for each cube of kTileVoxels cubed voxels.
std::uint64_t VoxelTile(std::uint64_t key);

/// The point of a voxel: the mean of what fell into it, weighted by certainty. `max_independent`
/// bounds the certainty that comes of adding points up, see ConfirmationOptions.
SurfacePoint MakeSurfacePoint(const Voxel& voxel, double voxel_size, double max_independent);

}  // namespace orb360
