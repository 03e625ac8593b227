#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "slam/depth/dense_view.h"
#include "slam/depth/exposure.h"
#include "slam/depth/geometric_consistency.h"
#include "slam/depth/voxel_grid.h"
#include <orb360/slam/depth/dense_cloud_summary.h>

namespace orb360 {

struct DenseCloudOptions {
  /// Side of the cubes each of which becomes one point, world units. Without a value it is a
  /// hundredth of the median range, for maps that are not metric.
  std::optional<double> voxel_size = 0.05;
  /// Farthest point from its view, and the largest expected error of a point, in voxels.
  double max_range_voxels = 600;
  double max_error_voxels = 4;
  /// Number of views with which each one is compared.
  int max_neighbours = 10;
  GeometricConsistencyOptions consistency{};
  /// How the colours of views are brought to one exposure. None: they stay as they are.
  std::optional<ExposureOptions> exposure = ExposureOptions();
  /// Views held in memory, 4 MB each for 1024 x 512 pixels. Two views and those that they
  /// are compared with are always held. Views are read again if this is less than the part of
  /// the path over which max_neighbours extend.
  int max_views = 32;
  /// Voxels held in memory, 150 bytes each. Voxels that have not been seen for the longest time are
  /// released first.
  size_t max_voxels = 1'400'000;
  int num_threads = 1;  // of OpenMP; the cloud does not depend on it
  /// Receives the number of views done, and of all, before each one, and 0 while their
  /// exposures are compared before that. May be null.
  std::function<void(int done, int count)> progress = {};
};

/// Receives voxels ordered by key. Several calls may give parts of the same voxel
/// (Voxel::operator+=). It is called on any thread, one call at a time.
using VoxelSink = std::function<void(std::span<const Voxel>)>;

/// Fuses the dense depth of views into one cloud: the points of each view that are
/// geometrically consistent with enough others (FindConsistentPoints) are added up in voxels, in
/// the order of the views. The result is the same for any number of threads.
DenseCloudStatistics FuseCloud(std::span<const DenseView> views, const DepthLoader& load,
                               const DenseCloudOptions& options, const VoxelSink& sink);

/// Returns a hundredth of the median of a few views' median ranges, or 1 if no view has any.
double ChooseVoxelSize(std::span<const DenseView> views, const DepthLoader& load);

/// Returns those of a view's neighbours with which it is compared: at distances from an eighth of
/// `median_range` to twice that range, before and after it. Near ones see the same pixels; far ones
/// reveal what moves and what is wrong.
std::vector<size_t> ChooseNeighbours(std::span<const DenseView> views, size_t view,
                                     double median_range, int max_neighbours);

/// Returns the median of the ranges of a view, weighted by solid angle, or 0 if it has none.
double MedianRange(const cv::Mat& range);

}  // namespace orb360
