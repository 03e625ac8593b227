#include "slam/features/sphere_pyramid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "slam/features/row_resample.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kLevelsPerOctave = 4;
constexpr int kMinWidth = 64;

// Describes how a level is resampled from a finer one; reads one pixel into its margin.
struct Resampling {
  const PyramidLevel* source;
  PyramidLevel* target;
  ResampleTaps columns;
  ResampleTaps rows;

  Resampling(const PyramidLevel& from, PyramidLevel* to)
      : source(&from),
        target(to),
        columns(from.camera.width(), to->camera.width()),
        rows(from.camera.height(), to->camera.height()) {}

  void ComputeRow(int y, std::vector<uint8_t>* scratch) const {
    const int source_width = source->camera.width();
    const ptrdiff_t stride = static_cast<ptrdiff_t>(source->padded.step);
    const uint8_t* upper = source->image().ptr(0) + rows.index[y] * stride - 1;
    scratch->resize(source_width + 2 + kResampleReach);
    BlendRows(upper, upper + stride, rows.weight[y], source_width + 2, scratch->data());
    ResampleRow(scratch->data() + 1, columns, target->image().ptr(y));
  }
};

// Computes the next octave, at exactly half of the size where that is possible.
void Halve(const PyramidLevel& source, PyramidLevel* target) {
  if (2 * target->camera.width() != source.camera.width() ||
      2 * target->camera.height() != source.camera.height()) {
    const Resampling resampling(source, target);
    std::vector<uint8_t> scratch;
    for (int y = 0; y < target->camera.height(); ++y) resampling.ComputeRow(y, &scratch);
    return;
  }
  const cv::Mat from = source.image();
  cv::Mat to = target->image();
  for (int y = 0; y < to.rows; ++y) {
    HalveRows(from.ptr(2 * y), from.ptr(2 * y + 1), to.cols, to.ptr(y));
  }
}

PyramidLevel MakeLevel(int width, int height, double scale) {
  return {EquirectangularCamera(width, height), scale,
          cv::Mat(height + 2 * PyramidLevel::kMarginY, width + 2 * PyramidLevel::kMarginX, CV_8U)};
}

SpherePyramid MakeLevels(int full_width, int full_height, int num_levels) {
  SpherePyramid levels = {MakeLevel(full_width, full_height, 1.0)};
  for (int l = 1; l < num_levels; ++l) {
    // In the first octave the width is a multiple of twice the columns, so that that of the next
    // octave is divisible too.
    const bool first_octave = l < kLevelsPerOctave;
    const int multiple = first_octave ? 2 * kSphereColumns : kSphereColumns;
    const EquirectangularCamera& source = levels[first_octave ? 0 : l - kLevelsPerOctave].camera;
    const double shrink = first_octave ? std::exp2(-l / double{kLevelsPerOctave}) : 0.5;
    const int width = static_cast<int>(std::lround(source.width() * shrink / multiple)) * multiple;
    const double proportional = static_cast<double>(source.height()) * width / source.width();
    const int height = first_octave ? 2 * static_cast<int>(std::lround(0.5 * proportional))
                                    : static_cast<int>(std::lround(proportional));
    if (width >= levels.back().camera.width() || width < kMinWidth ||
        height < PyramidLevel::kMarginY) {
      break;
    }
    levels.push_back(MakeLevel(width, height, full_width / static_cast<double>(width)));
  }
  return levels;
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
  // Across a pole the meridian continues at the opposite longitude.
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

void BuildSpherePyramid(const cv::Mat& gray, int num_levels, SpherePyramid* result,
                        int num_threads) {
  ORB360_CHECK(gray.type() == CV_8U && gray.cols >= kMinWidth &&
                   gray.rows >= PyramidLevel::kMarginY && num_levels > 0,
               gray.type(), gray.cols, gray.rows, num_levels);
  SpherePyramid& levels = *result;
  const bool reusable = !levels.empty() && levels[0].camera.width() == gray.cols &&
                        levels[0].camera.height() == gray.rows;
  if (!reusable) levels = MakeLevels(gray.cols, gray.rows, num_levels);
  gray.copyTo(levels[0].image());
  FillSphereMargin(&levels[0]);

  const int num_made = static_cast<int>(levels.size());
  std::vector<Resampling> resamplings;
  for (int l = 1; l < std::min(kLevelsPerOctave, num_made); ++l) {
    resamplings.emplace_back(levels[0], &levels[l]);
  }
#pragma omp parallel num_threads(num_threads)
  {
    std::vector<uint8_t> scratch;
    for (const Resampling& resampling : resamplings) {
#pragma omp for schedule(static) nowait
      for (int y = 0; y < resampling.target->camera.height(); ++y) {
        resampling.ComputeRow(y, &scratch);
      }
    }
#pragma omp barrier
    // A level and the level one octave above it are independent of the other levels.
#pragma omp for schedule(dynamic)
    for (int first = 0; first < std::min(kLevelsPerOctave, num_made); ++first) {
      if (first > 0) FillSphereMargin(&levels[first]);
      for (int l = first + kLevelsPerOctave; l < num_made; l += kLevelsPerOctave) {
        Halve(levels[l - kLevelsPerOctave], &levels[l]);
        FillSphereMargin(&levels[l]);
      }
    }
  }
}

}  // namespace orb360
