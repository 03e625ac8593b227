#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/surface_point.h"

namespace orb360 {

/// Sums over the points in one cube of a grid. The cube's point is computed from them, so parts of
/// the same voxel can be added later.
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

/// A point that is added to a grid.
struct VoxelSample {
  Eigen::Vector3d position;  // world
  Eigen::Vector3f normal;
  std::array<std::uint8_t, 3> rgb;
  float error;  // to be expected, world units
};

/// Cubes of one size in the world, filled with the points of one keyframe after the other.
class VoxelGrid {
 public:
  explicit VoxelGrid(double size) : size_(size) {}

  /// Adds the points of a keyframe. Points more than 2^20 voxels from the origin are left out.
  void Add(std::span<const VoxelSample> samples, int view);

  size_t num_voxels() const { return count_; }

  /// Removes and returns the half that has not received a point for the longest time, or
  /// everything; ordered by key.
  std::vector<Voxel> TakeOldest();
  std::vector<Voxel> TakeAll();

 private:
  std::vector<Voxel> Take(int last_view);
  /// Returns the entry of a key's voxel, or the free entry for it.
  Voxel& Find(std::uint64_t key);
  /// Makes room for `more` new voxels.
  void Reserve(size_t more);
  void Rebuild(std::span<const Voxel> voxels, size_t capacity);

  const double size_;
  std::vector<Voxel> slots_;  // open addressing, a power of two
  size_t count_ = 0;
};

/// Side, in voxels, of the cubes that VoxelTile numbers.
inline constexpr int kTileVoxels = 256;

/// Returns the number of the cube of kTileVoxels cubed voxels that contains the voxel.
std::uint64_t VoxelTile(std::uint64_t key);

/// Returns the point of a voxel: the mean of its samples, weighted by certainty. `max_independent`
/// bounds the certainty that is gained by adding points up, see GeometricConsistencyOptions.
SurfacePoint MakeSurfacePoint(const Voxel& voxel, double voxel_size, double max_independent);

}  // namespace orb360
