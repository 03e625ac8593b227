#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace orb360 {

/// A colour for each direction of the camera frame (-X forward, +Y right, +Z up), smooth enough to
/// be compared after interpolation, and different everywhere.
cv::Vec3b SphereColor(const Eigen::Vector3d& bearing);

/// An image whose pixels show SphereColor in the directions that `bearing_of` gives for their
/// centres, black where it gives none.
cv::Mat RenderLens(
    cv::Size size,
    const std::function<std::optional<Eigen::Vector3d>(double x, double y)>& bearing_of);

/// The full sphere that has `color_of` a direction.
cv::Mat RenderSphere(
    cv::Size size, const std::function<cv::Vec3b(const Eigen::Vector3d&)>& color_of = SphereColor);

/// How far two images of the sphere are from each other in direction.
struct FeatureErrors {
  int count = 0;
  double median = 0.0;      // degrees
  double percentile = 0.0;  // the 90th, degrees
};

/// Finds the patches around the corners of one image of the full sphere in another by normalized
/// correlation, within 12 pixels and to a fraction of a pixel, between the latitudes of -60 and 60
/// degrees, where the images are like those of a camera.
FeatureErrors CompareFeatures(const cv::Mat& a, const cv::Mat& b);

/// The median over the pixels of the mean absolute difference of colour.
double MedianColorDifference(const cv::Mat& a, const cv::Mat& b);

}  // namespace orb360
