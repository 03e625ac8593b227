#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "slam/geometry/camera.h"
#include "slam/map/map.h"

namespace orb360 {

struct SparseDepthOptions {
  /// Keyframes around this one whose landmarks are projected as well.
  int num_neighbours = 20;
  /// A landmark that the keyframe has not seen itself is taken to be hidden when, within this
  /// angle (radians), another one is nearer ...
  double occlusion_angle = 0.03;
  /// ... than this share of its range.
  double occlusion_ratio = 0.8;
  /// Landmarks found in less than this share of the frames that should show them are moving,
  /// hidden from here, or wrong.
  double min_found_share = 0.8;
  /// Confidence is 1/2 where the standard deviation of the range is this share of the range.
  double half_confidence_error = 0.1;
  /// Less confidence than this is mostly that of wrong landmarks, which the network trusts too
  /// much.
  double min_confidence = 0.5;
};

/// A landmark seen from a keyframe.
struct SparsePoint {
  LandmarkId landmark;
  Eigen::Vector2d pixel;  // of the camera asked for
  double range;           // along the ray, in the map's units
  double confidence;      // from min_confidence to 1, see RangeError
};

/// Standard deviation of a landmark's range from a keyframe as a share of the range: the angular
/// noise of its observations over the angle at which they see it from different places, less with
/// more of them, more where their residuals are larger than the noise explains.
/// Infinity where all observations come from one place.
double RangeError(const Map& map, const Landmark& landmark);

/// Sparse depth generation (paper III-B): the landmarks of a keyframe and of its neighbours,
/// projected into it; of several at one pixel the nearest, without hidden ones, without those that
/// move. Ordered by landmark.
std::vector<SparsePoint> ProjectLandmarks(const Map& map, KeyframeId keyframe,
                                          const EquirectangularCamera& camera,
                                          const SparseDepthOptions& options);

/// As images of the camera's size, CV_32F: range and confidence, 0 where there is no point.
struct SparseDepth {
  cv::Mat range;
  cv::Mat confidence;
};
SparseDepth RenderSparseDepth(const std::vector<SparsePoint>& points,
                              const EquirectangularCamera& camera);

}  // namespace orb360
