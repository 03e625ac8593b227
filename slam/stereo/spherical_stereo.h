#pragma once

#include <functional>
#include <optional>
#include <span>

#include <opencv2/core.hpp>

#include "slam/stereo/disparity_refinement.h"
#include "slam/stereo/disparity_triangulation.h"
#include "slam/stereo/inverse_ranges.h"
#include "slam/stereo/plane_disparities.h"
#include "slam/stereo/semi_global_matching.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// An image of the whole sphere (CV_8U, twice as wide as high) and where it was taken.
struct StereoView {
  cv::Mat gray;
  Rigid3 world_from_camera;
};

/// Finds the disparities of two rectified spheres (RectifySphere).
using DisparityMatcher =
    std::function<RefinedDisparities(const cv::Mat& first, const cv::Mat& second)>;

struct SphericalStereoOptions {
  SemiGlobalMatchingOptions matching;
  DisparityRefinementOptions refinement;
  DisparityTriangulationOptions triangulation;
  InverseRangeFusionOptions fusion;
  /// Takes the place of MatchSemiGlobally and RefineDisparities, for comparisons. May be null.
  DisparityMatcher matcher = {};
};

/// Measures the inverse ranges of `reference` from another view. Both are matched at the resolution
/// that is nearest to theirs and that MatchSemiGlobally takes. Throws ContractError unless both are
/// as large and were taken from different places. `plane`: one that the reference may see, such as
/// level ground below it, normal in the world's frame; it is tried beside what the images say by
/// themselves.
InverseRanges MatchSphere(const StereoView& reference, const StereoView& source,
                          const SphericalStereoOptions& options,
                          const std::optional<PlaneHypothesis>& plane = {});

/// Measures the inverse ranges of `reference` from several views and joins them
/// (FuseInverseRanges). The result does not depend on the number of threads.
InverseRanges MatchSpheres(const StereoView& reference, std::span<const StereoView> sources,
                           const SphericalStereoOptions& options, int num_threads = 1,
                           const std::optional<PlaneHypothesis>& plane = {});

}  // namespace orb360
