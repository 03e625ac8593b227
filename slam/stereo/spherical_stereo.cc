#include "slam/stereo/spherical_stereo.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "slam/stereo/rectified_sphere.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// The inverse ranges of the pixels of a rectified sphere, from the sine rule in the triangle of
// both cameras, `length` apart, and the point.
InverseRanges TriangulateDisparities(const RefinedDisparities& disparities, double length,
                                     const SphericalStereoOptions& options) {
  const cv::Size size = disparities.disparity.size();
  const double pixel_angle = std::numbers::pi / size.width;
  InverseRanges ranges{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F)};
  std::vector<float> cosines(size.width);
  std::vector<float> sines(size.width);
  for (int x = 0; x < size.width; ++x) {
    cosines[x] = static_cast<float>(std::cos((x + 0.5) * pixel_angle));
    sines[x] = static_cast<float>(std::sin((x + 0.5) * pixel_angle));
  }
  const auto least_sine = static_cast<float>(std::sin(options.min_epipolar_angle));
  const auto least_sigma = static_cast<float>(options.min_disparity_sigma);
  const auto spread_factor = static_cast<float>(options.disparity_sigma_factor);
  const auto scale = static_cast<float>(pixel_angle * length);
  for (int y = 0; y < size.height; ++y) {
    const float* disparity = disparities.disparity.ptr<float>(y);
    const float* sigma = disparities.sigma.ptr<float>(y);
    float* value = ranges.value.ptr<float>(y);
    float* deviation = ranges.sigma.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      value[x] = deviation[x] = 0;
      if (disparity[x] < 0 || sines[x] < least_sine) continue;
      const float angle = disparity[x] * static_cast<float>(pixel_angle);
      const float sine = std::sin(angle);
      const float across = sines[x] * std::cos(angle) + cosines[x] * sine;  // at the source view
      if (across < least_sine) continue;
      const float distance = across * static_cast<float>(length);
      value[x] = sine / distance;
      // Rows are nearer to each other towards the epipoles, so that a window there has fewer
      // independent pixels.
      const float spread = std::hypot(least_sigma, spread_factor * sigma[x] / std::sqrt(sines[x]));
      // The derivative by the disparity.
      deviation[x] = spread * scale * sines[x] / (distance * distance);
    }
  }
  return ranges;
}

// The power of two that is nearest to half of a panorama's width, by ratio.
int StereoWidth(int panorama_width) {
  const int exponent = static_cast<int>(std::lround(std::log2(0.5 * panorama_width)));
  return std::max(1 << exponent, kCoarsestStereoWidth);
}

void CheckViews(const StereoView& reference, const StereoView& source) {
  const Rigid3& pose1 = reference.world_from_camera;
  const Rigid3& pose2 = source.world_from_camera;
  ORB360_CHECK(
      reference.gray.size() == source.gray.size() && pose1.translation != pose2.translation,
      reference.gray.size(), source.gray.size());
}

}  // namespace

InverseRanges MatchSphere(const StereoView& reference, const StereoView& source,
                          const SphericalStereoOptions& options) {
  CheckViews(reference, source);
  const Eigen::Vector3d baseline =
      source.world_from_camera.translation - reference.world_from_camera.translation;
  const double length = baseline.norm();
  const Eigen::Matrix3d axes = BaselineAxes(baseline);
  const Eigen::Matrix3d reference_axes =
      reference.world_from_camera.rotation.conjugate().toRotationMatrix() * axes;
  const Eigen::Matrix3d source_axes =
      source.world_from_camera.rotation.conjugate().toRotationMatrix() * axes;
  const int width = StereoWidth(reference.gray.cols);
  const cv::Mat first = RectifySphere(reference.gray, reference_axes, width);
  const cv::Mat second = RectifySphere(source.gray, source_axes, width);
  const RefinedDisparities disparities =
      options.matcher
          ? options.matcher(first, second)
          : RefineDisparities(first, second, MatchSemiGlobally(first, second, options.matching),
                              options.refinement);
  return UnrectifySphere(TriangulateDisparities(disparities, length, options), reference_axes,
                         reference.gray.size());
}

InverseRanges MatchSpheres(const StereoView& reference, std::span<const StereoView> sources,
                           const SphericalStereoOptions& options, int num_threads) {
  for (const StereoView& source : sources) CheckViews(reference, source);
  std::vector<InverseRanges> measured(sources.size());
#pragma omp parallel for num_threads(num_threads) schedule(dynamic)
  for (size_t i = 0; i < sources.size(); ++i) {
    measured[i] = MatchSphere(reference, sources[i], options);
  }
  return FuseInverseRanges(measured, options.fusion, num_threads);
}

}  // namespace orb360
