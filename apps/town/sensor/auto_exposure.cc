#include "apps/town/sensor/auto_exposure.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace orb360::town {

double MeteredRadiance(const cv::Mat3f& panorama) {
  constexpr float kBlack = 1e-3F;  // so that a black pixel does not outweigh all others
  double sum = 0;
  double weights = 0;
  for (int row = 0; row < panorama.rows; ++row) {
    const double weight = std::sin(std::numbers::pi * (row + 0.5) / panorama.rows);  // solid angle
    for (const cv::Vec3f& pixel : std::span(panorama[row], static_cast<size_t>(panorama.cols))) {
      const float luminance = 0.0722F * pixel[0] + 0.7152F * pixel[1] + 0.2126F * pixel[2];
      sum += weight * std::log(std::max(luminance, kBlack));
    }
    weights += weight * panorama.cols;
  }
  return std::exp(sum / weights);
}

double ExposureGain(const AutoExposure& options, double metered) {
  const double wanted = std::log2(options.key / metered);
  const double most = std::floor(options.limit / options.step);
  return std::exp2(options.step * std::clamp(std::round(wanted / options.step), -most, most));
}

double ExposureGainAt(const AutoExposure& options, double seconds, const RadianceAt& meter) {
  constexpr double kRounding = 1e-6;  // of periods: frames at a multiple see what is metered then
  const double metered_at = options.period * std::floor(seconds / options.period + kRounding);
  return ExposureGain(options, MeteredRadiance(meter(metered_at)));
}

}  // namespace orb360::town
