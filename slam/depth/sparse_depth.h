#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "slam/geometry/camera.h"
#include "slam/map/map.h"

namespace orb360 {

struct SparseDepthOptions {
  /// Number of neighbouring keyframes whose landmarks are projected too.
  int num_neighbours = 20;
  /// A landmark that the keyframe has not observed is treated as hidden if, within this angle
  /// (radians), another landmark lies nearer than occlusion_ratio times its range.
  double occlusion_angle = 0.03;
  /// See occlusion_angle.
  double occlusion_ratio = 0.8;
  /// Landmarks found in less than this fraction of the frames that should show them move, are
  /// hidden from here, or are wrong.
  double min_found_fraction = 0.8;
  /// The confidence is 1/2 where the standard deviation of the range is this fraction of the range.
  double half_confidence_error = 0.1;
  /// Points with less confidence are mostly wrong landmarks, which the network trusts too much.
  double min_confidence = 0.5;
};

/// A landmark projected into a keyframe.
struct SparsePoint {
  LandmarkId landmark;
  Eigen::Vector2d pixel;  // of the camera asked for
  double range;           // along the ray, in the map's units
  double confidence;      // from min_confidence to 1, see RangeError
};

/// Returns the standard deviation of a landmark's range from a keyframe as a fraction of the range:
/// the angular noise of its observations over the angle between them, smaller with more
/// observations, and larger where their residuals exceed the noise. Infinite if all observations
/// come from one place.
double RangeError(const Map& map, const Landmark& landmark);

/// Generates sparse depth (paper III-B): projects the landmarks of a keyframe and of its neighbours
/// into it. The nearest landmark of a pixel is kept; hidden and moving landmarks are left out.
/// Ordered by landmark.
std::vector<SparsePoint> ProjectLandmarks(const Map& map, KeyframeId keyframe,
                                          const EquirectangularCamera& camera,
                                          const SparseDepthOptions& options);

/// Sparse depth as images of the camera's size, CV_32F: range and confidence, 0 where there is no
/// point.
struct SparseDepth {
  cv::Mat range;
  cv::Mat confidence;
};
SparseDepth RenderSparseDepth(const std::vector<SparsePoint>& points,
                              const EquirectangularCamera& camera);

}  // namespace orb360
