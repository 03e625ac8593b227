#pragma once

#include <array>
#include <cstdint>

#include <opencv2/core.hpp>

namespace orb360 {

/// New values for 8-bit values.
using ValueTable = std::array<std::uint8_t, 256>;

/// Replaces each channel of a colour.
inline void ApplyTable(const ValueTable& table, cv::Vec3b* color) {
  for (int i = 0; i < 3; ++i) (*color)[i] = table[(*color)[i]];
}

/// Finds the gain that makes two images of the same scene equally bright, from pairs of colours
/// that both show in the same directions. The gain multiplies the coded values: with a transfer
/// function that is a power, this is a gain of the light. It is the same for all channels: gains of
/// their own would tint what is saturated, such as a white sky.
class ExposureMatch {
 public:
  /// Adds what the first and the second image show in one direction.
  void Add(const cv::Vec3b& first, const cv::Vec3b& second);

  /// Returns tables for both images, which meet half-way in ratio. They change nothing where too
  /// few colours are comparable.
  std::array<ValueTable, 2> Tables() const;

 private:
  std::int64_t count_ = 0;
  std::array<std::int64_t, 2> sum_{};
};

}  // namespace orb360
