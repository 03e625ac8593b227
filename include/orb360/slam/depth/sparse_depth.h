#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include <orb360/slam/depth/sparse_depth_options.h>
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

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
