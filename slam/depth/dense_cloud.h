#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "slam/depth/dense_depth.h"
#include "slam/depth/surface_confirmation.h"
#include "slam/depth/voxel_grid.h"
#include "slam/geometry/rigid3.h"

namespace orb360 {

struct DenseCloudOptions {
  /// Side of the cubes of which each becomes one point, world units. Without a value: a hundredth
  /// of the median range, for maps that know no metres.
  std::optional<double> voxel_size = 0.05;
  /// Farthest point from its keyframe, and the largest error to be expected of one, in voxels.
  double max_range_voxels = 600;
  double max_error_voxels = 4;
  /// Keyframes that each one is compared with.
  int max_neighbours = 10;
  ConfirmationOptions confirmation{};
  /// Keyframes held in memory, at 4 MB each for 1024 x 512 pixels; two at a time and those that
  /// they are compared with in any case. They are read again where this is less than the path that
  /// max_neighbours extend over.
  int max_views = 32;
  /// Voxels held in memory, at 150 bytes each; what has not been seen for longest goes first.
  size_t max_voxels = 1'400'000;
  int num_threads = 1;  // of OpenMP; the cloud does not depend on it
};

/// A keyframe with dense depth, at the end of a run.
struct DenseView {
  int frame_index = 0;
  Rigid3 world_from_camera;
  /// World units in one unit of its ranges: the scale of the map at the end over that when they
  /// were made.
  double scale = 1.0;
  /// Other views (indices) whose poses fit this one's, because they see the same landmarks. Only
  /// those are compared.
  std::vector<size_t> neighbours;
};

struct DenseCloudStatistics {
  int views = 0;
  std::int64_t confirmed = 0;  // points, before they met in voxels
  double voxel_size = 0;       // world units
};

/// Gives the depth of a frame, perhaps several times that of the same one. The images must not
/// change afterwards. Called on any thread, one call at a time, but perhaps while the sink runs.
using DepthLoader = std::function<DenseDepth(int frame_index)>;
/// Takes voxels, ordered by key. Several calls may give parts of the same voxel
/// (Voxel::operator+=). Called on any thread, one call at a time.
using VoxelSink = std::function<void(std::span<const Voxel>)>;

/// Joins the dense depth of keyframes into one cloud: each keyframe's points that enough others
/// confirm (ConfirmSurface), met in voxels. In the order of the views. The same for any number of
/// threads.
DenseCloudStatistics FuseCloud(std::span<const DenseView> views, const DepthLoader& load,
                               const DenseCloudOptions& options, const VoxelSink& sink);

/// Those of a view's neighbours that it is compared with: at distances spread from an eighth of
/// `median_range` to twice that, before and after it. Near ones see the same pixels, far ones see
/// what moves and what is wrong.
std::vector<size_t> ChooseNeighbours(std::span<const DenseView> views, size_t view,
                                     double median_range, int max_neighbours);

/// Median of the ranges of a view, weighted by solid angle; 0 if it has none.
double MedianRange(const cv::Mat& range);

}  // namespace orb360
