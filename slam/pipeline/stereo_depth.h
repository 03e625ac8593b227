#pragma once

#include <span>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/io/depth_map_store.h"
#include "slam/io/gray_image_store.h"
#include "slam/stereo/spherical_stereo.h"
#include <orb360/slam/depth/depth_completer.h>
#include <orb360/slam/pipeline/frame_report.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

struct StereoDepthOptions {
  /// Least confidence of the completed pixels whose ranges have the median.
  double min_trusted_confidence = 0.8;
  /// Distances of the source views from the reference view, as multiples of that median. On each
  /// side of the path the frame is taken whose distance is nearest to each of these by ratio.
  std::vector<double> baselines = {0.12, 0.4};
  /// Largest ratio between that distance and the one wanted.
  double max_baseline_ratio = 2.7;
  /// Side of the squares of pixels of which one with a range by stereo, if there is one, is given
  /// to the network.
  int sparse_spacing = 6;
  /// Least fraction of the squares that have one; a keyframe with fewer stays as it was completed.
  double min_fraction = 0.03;
  /// The confidence of such a pixel follows from the same error as that of a landmark.
  SparseDepthOptions sparse = {};
  /// Number by which the errors that the network expects are multiplied: where it has not been
  /// trained, they are larger than it says (docs/results/stereo.md).
  double completion_error_factor = 3.0;
  SphericalStereoOptions stereo = {};
};

/// Returns the frames that see what a view sees, ordered by index: the neighbours of the view and,
/// of `frames`, those between two keyframes that follow each other and are neighbours or the view
/// itself. `views` and `frames` are ordered by index, and their poses are in the same world.
std::vector<FramePose> FindStereoCandidates(std::span<const DenseView> views, size_t reference,
                                            std::span<const FramePose> frames);

/// Returns those of the candidates from which the ranges of a view are measured
/// (StereoDepthOptions), in the order of preference.
std::vector<FramePose> ChooseStereoSources(std::span<const FramePose> candidates,
                                           const DenseView& reference, double median_range,
                                           const StereoDepthOptions& options);

/// Measures the ranges of stored keyframes by multi-view stereo with their final poses, and
/// completes them from these. What is seen is kept; the network fills the rest. A keyframe without
/// source views or of which little is seen stays as it is. Returns the number of the others.
/// `frames` are those whose images are in `images`; `views` those whose depth is in `store`. The
/// result does not depend on the number of threads. Throws UserError where the disk fails.
int MeasureDepth(std::span<const DenseView> views, std::span<const FramePose> frames,
                 const StereoDepthOptions& options, const DepthMapStore& store,
                 const GrayImageStore& images, DepthCompleter* completer, int num_threads,
                 const KeyframeProgress& progress = nullptr);

}  // namespace orb360
