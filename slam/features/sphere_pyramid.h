#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include <orb360/slam/geometry/camera.h>

namespace orb360 {

/// Number of columns of cells on every pyramid level. Level widths are multiples of it (except
/// level 0, which is the input). Rolling the input by k/32 of its width therefore rolls every level
/// by whole pixels and whole cells, and the features are exactly the same.
inline constexpr int kSphereColumns = 32;

/// One level of the pyramid: an equirectangular image with a margin that continues the sphere.
struct PyramidLevel {
  /// Margins in pixels. The horizontal one is the reach of a descriptor (tangent_sampling.h), of
  /// the blur, and the three further bytes that gathering reads; the vertical one is the
  /// descriptor's radius and the blur.
  static constexpr int kMarginX = 32;
  static constexpr int kMarginY = 24;

  EquirectangularCamera camera;
  /// Number of level-0 pixels per pixel of this level, horizontally: the scale of its features.
  double scale;
  /// CV_8U, (height + 2 kMarginY) x (width + 2 kMarginX). Longitude wraps; across a pole, row -1 -
  /// i is row i turned by half the width.
  cv::Mat padded;

  /// The image without its margin. Pointers into it may reach into the margin.
  cv::Mat image() const {
    return padded(cv::Rect(kMarginX, kMarginY, camera.width(), camera.height()));
  }
};

using SpherePyramid = std::vector<PyramidLevel>;

/// Builds the pyramid. Scales grow by 2^(1/4) per level: levels 1 to 3 are resampled from the
/// input, and level l + 4 is level l at half size. `gray` is CV_8U and covers the whole sphere.
/// Levels narrower than 64 pixels are left out. `levels` is empty or comes from an earlier call
/// with the same number and size; its memory is reused. Runs on `num_threads` OpenMP threads; the
/// result does not depend on how many.
void BuildSpherePyramid(const cv::Mat& gray, int num_levels, SpherePyramid* levels,
                        int num_threads = 1);

/// Returns the gray value at a pixel (continuous coordinates), interpolated bilinearly. Contract:
/// it lies in the level or at least one pixel inside the level's margin.
inline float SampleBilinear(const PyramidLevel& level, float u, float v) {
  const float x = u + (PyramidLevel::kMarginX - 0.5f);  // of the padded image, positive
  const float y = v + (PyramidLevel::kMarginY - 0.5f);
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const float a = x - static_cast<float>(column);
  const float b = y - static_cast<float>(row);
  const uint8_t* upper = level.padded.ptr(row) + column;
  const uint8_t* lower = upper + level.padded.step;
  const float top = static_cast<float>(upper[0]) + a * static_cast<float>(upper[1] - upper[0]);
  const float bottom = static_cast<float>(lower[0]) + a * static_cast<float>(lower[1] - lower[0]);
  return top + b * (bottom - top);
}

/// Fills the margins of a level from its image.
void FillSphereMargin(PyramidLevel* level);

}  // namespace orb360
