#include "slam/io/lenses/exposure.h"

#include <algorithm>
#include <cmath>

namespace orb360 {

void ExposureMatch::Add(const cv::Vec3b& first, const cv::Vec3b& second) {
  // Saturated values have lost their ratio, and dark ones are noise and the black rim of the lens.
  constexpr int kMin = 16;
  constexpr int kMax = 240;
  for (int i = 0; i < 3; ++i) {
    if (std::min(first[i], second[i]) < kMin || std::max(first[i], second[i]) > kMax) return;
  }
  ++count_;
  for (int i = 0; i < 3; ++i) {
    sum_[0] += first[i];
    sum_[1] += second[i];
  }
}

std::array<ValueTable, 2> ExposureMatch::Tables() const {
  constexpr std::int64_t kMinPairs = 500;
  constexpr double kMaxGain = 2.0;
  double gain = 1.0;  // of the first image
  if (count_ >= kMinPairs) {
    const double ratio = static_cast<double>(sum_[1]) / static_cast<double>(sum_[0]);
    gain = std::clamp(std::sqrt(ratio), 1.0 / kMaxGain, kMaxGain);
  }
  std::array<ValueTable, 2> tables;
  for (int value = 0; value < 256; ++value) {
    tables[0][value] = cv::saturate_cast<uchar>(value * gain);
    tables[1][value] = cv::saturate_cast<uchar>(value / gain);
  }
  return tables;
}

}  // namespace orb360
