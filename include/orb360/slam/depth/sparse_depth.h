#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include <orb360/slam/depth/sparse_depth_options.h>
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// A landmark projected into a keyframe.
struct SparsePoint {
  LandmarkId landmark;    ///< The landmark that is projected.
  Eigen::Vector2d pixel;  ///< Continuous pixel of the camera that was asked for.
  double range;           ///< Range along the pixel's ray, in the map's unit.
  /// SparseConfidence of the landmark's RangeError; at least min_confidence.
  double confidence;
};

/// Returns the standard deviation of a landmark's range from a keyframe as a fraction of the range:
/// the angular noise of its observations over the angle between them, smaller with more
/// observations, and larger where their residuals exceed the noise. Infinite if all observations
/// come from one place.
double RangeError(const Map& map, const Landmark& landmark);

/// Returns 1 / (1 + (e / half_confidence_error)^2), the confidence of a point of sparse depth whose
/// range has the standard deviation e as a fraction of the range.
double SparseConfidence(double relative_error, const SparseDepthOptions& options);

/// Generates sparse depth (paper III-B): projects the landmarks of a keyframe and of its neighbours
/// into it. The nearest landmark of a pixel is kept; hidden and moving landmarks are left out. The
/// points are ordered by landmark. Contract: the keyframe exists.
std::vector<SparsePoint> ProjectLandmarks(const Map& map, KeyframeId keyframe,
                                          const EquirectangularCamera& camera,
                                          const SparseDepthOptions& options);
/// The same for a camera at any pose, with the landmarks of a keyframe near it and of the
/// neighbours of that. At the pose of the keyframe both are the same.
std::vector<SparsePoint> ProjectLandmarks(const Map& map, KeyframeId near,
                                          const Rigid3& world_from_camera,
                                          const EquirectangularCamera& camera,
                                          const SparseDepthOptions& options);

/// Sparse depth as images of one camera.
struct SparseDepth {
  cv::Mat range;       ///< CV_32FC1: range along each pixel's ray; 0 where there is no point.
  cv::Mat confidence;  ///< CV_32FC1: confidence in (0, 1]; 0 where there is no point.
};
/// Returns images of the camera's size with the range and the confidence of each point at its
/// pixel.
SparseDepth RenderSparseDepth(const std::vector<SparsePoint>& points,
                              const EquirectangularCamera& camera);

}  // namespace orb360
