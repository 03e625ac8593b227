#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace orb360::town {

/// Converts radiance to 8-bit sRGB: a filmic curve (Hable's form fitted by Narkowicz 2015, with a
/// longer toe so that shade keeps its detail), then the sRGB transfer function.
class ToneCurve {
 public:
  ToneCurve() {
    for (size_t i = 0; i < table_.size(); ++i) {
      const double root = static_cast<double>(i) / (table_.size() - 1);
      const double x = kExposure * kMaximum * root * root;
      const double film =
          std::clamp(x * (2.51 * x + 0.08) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
      const double srgb =
          film <= 0.0031308 ? 12.92 * film : 1.055 * std::pow(film, 1 / 2.4) - 0.055;
      table_[i] = static_cast<uint8_t>(std::lround(255 * srgb));
    }
  }
  /// Returns blue, green, red from linear red, green, blue.
  cv::Vec3b Encode(const Eigen::Vector3f& radiance) const {
    return {Encode(radiance.z()), Encode(radiance.y()), Encode(radiance.x())};
  }

 private:
  static constexpr double kExposure = 0.72;
  static constexpr float kMaximum = 8.0F;  // of radiance; the table is over its square root

  uint8_t Encode(float x) const {
    const float root = std::sqrt(std::clamp(x * (1 / kMaximum), 0.0F, 1.0F));
    return table_[static_cast<size_t>(root * static_cast<float>(table_.size() - 1) + 0.5F)];
  }

  std::array<uint8_t, 4096> table_;
};

}  // namespace orb360::town
