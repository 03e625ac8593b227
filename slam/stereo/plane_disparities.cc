#include "slam/stereo/plane_disparities.h"

#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// The bearings of every `kStep`th pixel are enough: the disparities of a plane are smooth.
constexpr int kStep = 4;
/// Least cosine between a bearing and the plane's normal. Towards its horizon a plane says nothing.
constexpr double kMinCosine = 0.02;

}  // namespace

cv::Mat PlaneDisparities(const PlaneHypothesis& plane, double length, int width) {
  ORB360_CHECK(plane.distance > 0 && length > 0 && width % kStep == 0, plane.distance, length,
               width);
  const int columns = width / kStep;
  const double step = std::numbers::pi / columns;
  cv::Mat coarse(2 * columns, columns, CV_32F);
  cv::Mat cosines(2 * columns, columns, CV_32F);
  for (int y = 0; y < coarse.rows; ++y) {
    const double azimuth = (y + 0.5) * step;
    const double across =
        plane.normal.y() * std::cos(azimuth) + plane.normal.z() * std::sin(azimuth);
    for (int x = 0; x < columns; ++x) {
      const double cosine = std::cos((x + 0.5) * step);
      const double sine = std::sin((x + 0.5) * step);
      const double towards = -(plane.normal.x() * cosine + across * sine);
      cosines.at<float>(y, x) = static_cast<float>(towards);
      // The angle at the point between both cameras, times range / distance.
      const double scaled = length * std::max(towards, 0.0) / plane.distance;
      coarse.at<float>(y, x) = static_cast<float>(std::atan2(scaled * sine, 1 - scaled * cosine) *
                                                  width / std::numbers::pi);
    }
  }
  const cv::Size size(width, 2 * width);
  cv::Mat disparities;
  cv::resize(coarse, disparities, size, 0, 0, cv::INTER_LINEAR);
  cv::resize(cosines, cosines, size, 0, 0, cv::INTER_LINEAR);
  disparities.setTo(-1.0F, cosines < kMinCosine);
  return disparities;
}

}  // namespace orb360
