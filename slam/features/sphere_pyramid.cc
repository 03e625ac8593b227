#include "slam/features/sphere_pyramid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "slam/check.h"

namespace orb360 {
namespace {

constexpr int kLevelsPerOctave = 4;
// Bilinear weights are in 1/128: two passes of 7 bits on 8-bit pixels fit 32-bit lanes easily.
constexpr int kWeightBits = 7;
constexpr int kWeightOne = 1 << kWeightBits;

struct Tap {
  int index;   // of the first of two neighbouring source samples
  int weight;  // of the second, in 1/kWeightOne
};

// Source position of every destination sample, pixel centre to pixel centre, in exact rational
// arithmetic: with both sizes divisible by 32 the taps then repeat exactly 32 times around.
std::vector<Tap> MakeTaps(int source_size, int target_size) {
  std::vector<Tap> taps(target_size);
  for (int i = 0; i < target_size; ++i) {
    // (i + 1/2) * source / target - 1/2, as a fraction over 2 * target.
    const int64_t numerator = int64_t{2 * i + 1} * source_size - target_size;
    const int64_t denominator = int64_t{2} * target_size;
    const int64_t index = numerator >= 0 ? numerator / denominator : -1;
    const int64_t remainder = numerator - index * denominator;
    taps[i] = {static_cast<int>(index),
               static_cast<int>((remainder * kWeightOne + target_size) / denominator)};
  }
  return taps;
}

// Bilinear resampling; reads one pixel into the source's margin.
void Resample(const PyramidLevel& source, PyramidLevel* target) {
  const int source_width = source.camera.width();
  const std::vector<Tap> columns = MakeTaps(source_width, target->camera.width());
  const std::vector<Tap> rows = MakeTaps(source.camera.height(), target->camera.height());
  const cv::Mat from = source.image();
  cv::Mat to = target->image();
#pragma omp parallel
  {
    std::vector<uint16_t> blended(source_width + 2);
#pragma omp for schedule(static)
    for (int y = 0; y < to.rows; ++y) {
      const uint8_t* upper = from.ptr(0) + rows[y].index * static_cast<int64_t>(from.step) - 1;
      const uint8_t* lower = upper + from.step;
      const uint16_t weight = rows[y].weight;
      for (int x = 0; x < source_width + 2; ++x) {
        blended[x] = upper[x] * (kWeightOne - weight) + lower[x] * weight;
      }
      uint8_t* out = to.ptr(y);
      for (int x = 0; x < to.cols; ++x) {
        const uint16_t* pair = blended.data() + columns[x].index + 1;
        const uint32_t sum =
            pair[0] * (kWeightOne - columns[x].weight) + pair[1] * columns[x].weight;
        out[x] = (sum + (1 << (2 * kWeightBits - 1))) >> (2 * kWeightBits);
      }
    }
  }
}

void HalveSize(const PyramidLevel& source, PyramidLevel* target) {
  const cv::Mat from = source.image();
  cv::Mat to = target->image();
#pragma omp parallel for schedule(static)
  for (int y = 0; y < to.rows; ++y) {
    const uint8_t* upper = from.ptr(2 * y);
    const uint8_t* lower = from.ptr(2 * y + 1);
    uint8_t* out = to.ptr(y);
    for (int x = 0; x < to.cols; ++x) {
      out[x] = (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1] + 2) >> 2;
    }
  }
}

PyramidLevel MakeLevel(int width, int height, double scale) {
  return {EquirectangularCamera(width, height), scale,
          cv::Mat(height + 2 * PyramidLevel::kMarginY, width + 2 * PyramidLevel::kMarginX, CV_8U)};
}

}  // namespace

void FillSphereMargin(PyramidLevel* level) {
  constexpr int kX = PyramidLevel::kMarginX;
  constexpr int kY = PyramidLevel::kMarginY;
  const int width = level->camera.width();
  const int height = level->camera.height();
  cv::Mat& padded = level->padded;
  for (int y = kY; y < kY + height; ++y) {
    uint8_t* row = padded.ptr(y);
    std::memcpy(row, row + width, kX);
    std::memcpy(row + kX + width, row + kX, kX);
  }
  // Across the pole the same meridian goes on at the opposite longitude.
  const auto cross_pole = [&](int target, int source) {
    uint8_t* out = padded.ptr(target);
    const uint8_t* in = padded.ptr(source) + kX;
    int x = (width / 2 + width - kX) % width;
    for (int i = 0; i < width + 2 * kX; ++i) {
      out[i] = in[x];
      if (++x == width) x = 0;
    }
  };
  for (int i = 0; i < kY; ++i) {
    cross_pole(kY - 1 - i, kY + i);
    cross_pole(kY + height + i, kY + height - 1 - i);
  }
}

std::vector<PyramidLevel> BuildSpherePyramid(const cv::Mat& gray, int num_levels) {
  ORB360_CHECK(gray.type() == CV_8U && gray.cols >= PyramidLevel::kMarginX &&
                   gray.rows >= PyramidLevel::kMarginY && num_levels > 0,
               gray.type(), gray.cols, gray.rows, num_levels);
  std::vector<PyramidLevel> levels;
  levels.reserve(num_levels);  // references to earlier levels stay valid
  levels.push_back(MakeLevel(gray.cols, gray.rows, 1.0));
  gray.copyTo(levels[0].image());
  FillSphereMargin(&levels[0]);
  for (int l = 1; l < num_levels; ++l) {
    if (l < kLevelsPerOctave) {
      // Twice the column count, so that the level an octave above still divides by it.
      constexpr int kMultiple = 2 * kSphereColumns;
      const double ideal = gray.cols * std::exp2(-l / static_cast<double>(kLevelsPerOctave));
      const int width = std::max(1, static_cast<int>(std::lround(ideal / kMultiple))) * kMultiple;
      const int height = 2 * static_cast<int>(std::lround(0.5 * gray.rows * width / gray.cols));
      if (width >= levels.back().camera.width() || height < PyramidLevel::kMarginY) break;
      levels.push_back(MakeLevel(width, height, gray.cols / static_cast<double>(width)));
      Resample(levels[0], &levels.back());
    } else {
      const PyramidLevel& source = levels[l - kLevelsPerOctave];
      const int width = source.camera.width() / 2;
      const int height = source.camera.height() / 2;
      if (width < PyramidLevel::kMarginX || height < PyramidLevel::kMarginY) break;
      levels.push_back(MakeLevel(width, height, 2.0 * source.scale));
      HalveSize(source, &levels.back());
    }
    FillSphereMargin(&levels.back());
  }
  return levels;
}

}  // namespace orb360
