#include "slam/stereo/spherical_stereo.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/stereo/rectified_sphere.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

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
                          const SphericalStereoOptions& options,
                          const std::optional<PlaneHypothesis>& plane) {
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
  RefinedDisparities disparities;
  if (options.matcher) {
    disparities = options.matcher(first, second);
  } else {
    cv::Mat hypothesis;
    if (plane) {
      hypothesis = PlaneDisparities({axes.transpose() * plane->normal, plane->distance}, length,
                                    SearchedWidth(width, options.matching));
    }
    disparities = RefineDisparities(first, second,
                                    MatchSemiGlobally(first, second, options.matching, hypothesis),
                                    options.refinement);
  }
  return UnrectifySphere(TriangulateDisparities(disparities, length, options.triangulation),
                         reference_axes, reference.gray.size());
}

InverseRanges MatchSpheres(const StereoView& reference, std::span<const StereoView> sources,
                           const SphericalStereoOptions& options, int num_threads,
                           const std::optional<PlaneHypothesis>& plane) {
  for (const StereoView& source : sources) CheckViews(reference, source);
  std::vector<InverseRanges> measured(sources.size());
#pragma omp parallel for num_threads(num_threads) schedule(dynamic)
  for (size_t i = 0; i < sources.size(); ++i) {
    measured[i] = MatchSphere(reference, sources[i], options, plane);
  }
  return FuseInverseRanges(measured, options.fusion, num_threads);
}

}  // namespace orb360
