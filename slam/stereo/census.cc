#include "slam/stereo/census.h"

#include <algorithm>
#include <cstddef>

namespace orb360 {

CensusImage TransformCensus(const cv::Mat& gray, int num_threads) {
  constexpr int kRadius = 2;
  const int width = gray.cols;
  const int height = gray.rows;
  cv::Mat padded(height + 2 * kRadius, width + 2 * kRadius, CV_8U);
  for (int y = -kRadius; y < height + kRadius; ++y) {
    const uint8_t* from = gray.ptr((y + height) % height);
    uint8_t* to = padded.ptr(y + kRadius) + kRadius;
    for (int x = -kRadius; x < width + kRadius; ++x) to[x] = from[std::clamp(x, 0, width - 1)];
  }
  CensusImage census{
      width, height,
      std::vector<uint32_t>(static_cast<size_t>(width) * static_cast<size_t>(height))};
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (int y = 0; y < height; ++y) {
    uint32_t* to = &census.signatures[static_cast<size_t>(y) * static_cast<size_t>(width)];
    const uint8_t* center = padded.ptr(y + kRadius) + kRadius;
    for (int i = -kRadius; i <= kRadius; ++i) {
      const uint8_t* around = padded.ptr(y + kRadius + i) + kRadius;
      for (int j = -kRadius; j <= kRadius; ++j) {
        if (i == 0 && j == 0) continue;
        for (int x = 0; x < width; ++x) to[x] = 2 * to[x] + (around[x + j] < center[x] ? 1U : 0U);
      }
    }
  }
  return census;
}

}  // namespace orb360
