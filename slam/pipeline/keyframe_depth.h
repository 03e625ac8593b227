#pragma once

#include <functional>
#include <span>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/io/depth_map_store.h"
#include "slam/io/image_store.h"
#include "slam/stereo/spherical_stereo.h"
#include <orb360/slam/depth/depth_completer.h>
#include <orb360/slam/pipeline/keyframe_depth_report.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

struct KeyframeDepthOptions {
  /// Least confidence of the completed pixels whose ranges have the median.
  double min_trusted_confidence = 0.8;
  /// Distances of the source views from the reference view, as multiples of that median, in the
  /// keyframe before. On each side of the path the frame is taken whose distance is nearest to each
  /// of these by ratio. Empty: no stereo.
  std::vector<double> baselines = {0.12, 0.4};
  /// Largest ratio between that distance and the one wanted.
  double max_baseline_ratio = 2.7;
  /// Side of the squares of pixels of which one with a range by stereo, if there is one, is given
  /// to the network.
  int sparse_spacing = 6;
  /// Least fraction of the squares that have one; of a keyframe with fewer, stereo counts for
  /// nothing.
  double min_fraction = 0.03;
  /// The confidence of such a pixel follows from the same error as that of a landmark.
  SparseDepthOptions sparse = {};
  /// Least number of landmarks of a keyframe of which stereo measures nothing. One with fewer gets
  /// no depth.
  int min_points = 50;
  /// Number by which the errors that the network expects are multiplied beside stereo: where it has
  /// not been trained, they are larger than it says (docs/results/stereo.md).
  double completion_error_factor = 5.0;
  /// Whether the depth has what the network completes. Otherwise it has what stereo measures.
  bool keeps_completed = true;
  SphericalStereoOptions stereo = {};
};

/// Returns the frames that see what a view sees, ordered by index: the neighbours of the view and,
/// of `frames`, those between two keyframes that follow each other and are neighbours or the view
/// itself. `views` and `frames` are ordered by index, and their poses are in the same world.
std::vector<FramePose> FindStereoCandidates(std::span<const DenseView> views, size_t reference,
                                            std::span<const FramePose> frames);

/// Returns those of the candidates from which the ranges of a view are measured
/// (KeyframeDepthOptions), in the order of preference.
std::vector<FramePose> ChooseStereoSources(std::span<const FramePose> candidates,
                                           const DenseView& reference, double median_range,
                                           const KeyframeDepthOptions& options);

/// Returns the landmarks that a view sees (ProjectLandmarks), in the unit of its pose.
using LandmarkProjector = std::function<std::vector<SparsePoint>(const DenseView& view)>;

/// Computes the depth of keyframes and puts it into `store`. Ranges are measured by multi-view
/// stereo with the final poses of the keyframes and of the frames around them; the network
/// completes the rest from these and from landmarks. What is seen is kept. After `progress` has
/// returned false, the rest is left to the network. `frames` are those that may be sources; their
/// images and those of the views are in `images`. The result does not depend on the number of
/// threads. Throws UserError where the disk fails.
KeyframeDepthReport ComputeDepth(std::span<const DenseView> views,
                                 std::span<const FramePose> frames,
                                 const LandmarkProjector& landmarks_of,
                                 const KeyframeDepthOptions& options, const ImageStore& images,
                                 DepthCompleter* completer, int num_threads,
                                 const DepthMapStore& store,
                                 const KeyframeProgress& progress = nullptr);

}  // namespace orb360
