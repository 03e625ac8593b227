#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/dense_cloud.h"
#include "slam/depth/dense_ground.h"
#include "slam/depth/moving_objects.h"
#include "slam/depth/reprojected_points.h"
#include "slam/io/depth_map_store.h"
#include "slam/io/image_store.h"
#include "slam/stereo/spherical_stereo.h"
#include <orb360/slam/depth/depth_completer.h>
#include <orb360/slam/pipeline/reconstruction.h>
#include <orb360/slam/pipeline/view_depth_report.h>

namespace orb360 {

/// Of the second pass (CompleteViews).
struct ViewCompletionOptions {
  /// Distances of the views whose points a view gets, as multiples of the median of its ranges, on
  /// each side of the path.
  std::vector<double> distances = {0.4, 0.8, 1.6, 3.2, 6.4};
  /// Distances of the views that tell whether there is ground where an object is, in heights of the
  /// camera. A car has left its place on the way.
  std::vector<double> ground_distances = {3, 4.5, 6.5, 9};
  /// Largest ratio between a distance and the one wanted: the root of 2, by which they are apart.
  double max_distance_ratio = 1.42;
  MovingObjectOptions objects = {};
  DenseGroundOptions ground = {};
};

struct ViewDepthOptions {
  /// Least distance between two reference views that follow each other, as a multiple of the median
  /// range of the surroundings. 0: every view gets depth, but of those at one place only the first.
  double spacing = 0.25;
  /// Number of reference views along a path that is short for that: their distance is at most the
  /// length of the path divided by it.
  int min_views = 12;
  /// Least confidence of the completed pixels whose ranges have the median.
  double min_trusted_confidence = 0.8;
  /// Distances of the source views from the reference view, as multiples of that median, in the
  /// reference view before. On each side of the path the view is taken whose distance is nearest to
  /// each of these by ratio. At the ends of a path, where one side has none, others of the other
  /// side take their place, farther away. Empty: no stereo.
  std::vector<double> baselines = {0.12, 0.4};
  /// Largest ratio between that distance and the one wanted.
  double max_baseline_ratio = 2.7;
  /// Side of the squares of pixels of which one with a range by stereo, if there is one, is given
  /// to the network.
  int sparse_spacing = 6;
  /// Least fraction of the squares that have one; of a view with fewer, stereo counts for nothing.
  double min_fraction = 0.03;
  /// The confidence of such a pixel follows from the same error as that of a landmark.
  SparseDepthOptions sparse = {};
  /// Least number of landmarks in a view of which stereo measures nothing. One with fewer gets no
  /// depth.
  int min_points = 50;
  /// Number by which the errors that the network expects are multiplied beside stereo, as measured
  /// on worlds that it has not been trained on (docs/results/stereo.md).
  double completed_error_factor = 1.3;
  /// Height of the camera over the ground, in the unit of the poses of views; 0: not known.
  double camera_height = 0;
  /// Whether the depth has what the network completes. Otherwise it has what stereo measures.
  bool keeps_completed = true;
  SphericalStereoOptions stereo = {};
  ViewCompletionOptions second = {};
};

/// Returns those of `neighbours` of a view from which its ranges are measured (ViewDepthOptions):
/// indices into `views`, in the order of preference.
std::vector<size_t> ChooseStereoSources(std::span<const DenseView> views, size_t reference,
                                        std::span<const size_t> neighbours, double median_range,
                                        const ViewDepthOptions& options);

/// Returns the views that see what a view sees: indices, ordered.
using NeighbourFinder = std::function<std::vector<size_t>(size_t view)>;

/// Returns the landmarks that a view sees (ProjectLandmarks), in the unit of its pose.
using LandmarkProjector = std::function<std::vector<SparsePoint>(const DenseView& view)>;

/// Computes the depth of reference views and puts it into `store`, in two passes.
///
/// 1. Reference views are chosen along the path by their distance over the range of the
///    surroundings. Their ranges are measured by multi-view stereo with the final poses of the
///    views around them; the network completes the rest from these and from landmarks. The result
///    goes into `first`. A view that gets no depth counts for the distance like any other.
/// 2. Each is completed anew with what was measured in the views around it (CompleteViews; `up` is
///    the normal of the ground in the world, if it is known).
///
/// What is measured is kept. After the progress, which counts both passes, has returned false, the
/// rest is left to the network. `views` are ordered by frame, and their images are in `images`. The
/// result does not depend on the number of threads. Throws UserError where the disk fails.
ViewDepthReport ComputeDepth(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                             const LandmarkProjector& landmarks_of,
                             const std::optional<Eigen::Vector3d>& up,
                             const ViewDepthOptions& options, const ImageStore& images,
                             DepthCompleter* completer, int num_threads, const DepthMapStore& first,
                             const DepthMapStore& store, const ViewDepthCallbacks& callbacks = {});

}  // namespace orb360
