#include "slam/features/sphere_band.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "slam/features/blur.h"
#include "slam/features/row_resample.h"

namespace orb360 {
namespace {

constexpr int kMarginX = PyramidLevel::kMarginX;
constexpr int kMarginY = PyramidLevel::kMarginY;
constexpr int kReach = 3;  // of the blur

// The bands between 45 degrees south and north are not compressed.
constexpr int kFirstWhole = kSphereBands / 4;
constexpr int kLastWhole = kSphereBands - 1 - kFirstWhole;

bool IsWhole(int index) { return index >= kFirstWhole && index <= kLastWhole; }

// Cosine of the latitude of the band's middle, which is the mean aspect ratio of its pixels on the
// sphere.
double CosineOfBand(int index) { return std::sin(std::numbers::pi * (index + 0.5) / kSphereBands); }

// Widths from the level's to the band's. Each is at least half of the previous one, so that two
// taps are enough for a step. All are multiples of the number of cells, so that a roll by whole
// cells remains one.
std::vector<ResampleTaps> Steps(int level_width, int band_width) {
  std::vector<ResampleTaps> steps;
  for (int width = level_width; width > band_width;) {
    const int half = (width / kSphereColumns + 1) / 2 * kSphereColumns;
    const int next = std::max(half, band_width);
    steps.emplace_back(width, next);
    width = next;
  }
  return steps;
}

// Compresses all rows of the band to its width and adds margins on the left and right.
void Compress(const PyramidLevel& level, SphereBand* band) {
  const int level_width = level.camera.width();
  std::vector<uint8_t> row(level_width + 2 + kResampleReach);
  for (int r = 0; r < band->padded.rows; ++r) {
    std::memcpy(row.data() + 1, level.padded.ptr(band->first_row + r + kMarginY) + kMarginX,
                level_width);
    int width = level_width;
    for (const ResampleTaps& taps : band->compression) {
      row[0] = row[width];
      row[width + 1] = row[1];
      ResampleRow(row.data() + 1, taps, row.data() + 1);
      width = taps.size();
    }
    uint8_t* out = band->padded.ptr(r) + kMarginX;
    std::memcpy(out, row.data() + 1, band->width);
    std::memcpy(out - kMarginX, out + band->width - kMarginX, kMarginX);
    std::memcpy(out + band->width, out, kMarginX);
  }
}

// Blurs rows [first, last), all columns except the outermost ones, beyond which the blur would
// read.
void BlurRows(const cv::Mat& from, int first, int last, cv::Mat* to) {
  BlurImage(from.ptr(first) + kReach, static_cast<ptrdiff_t>(from.step), from.cols - 2 * kReach,
            last - first, to->ptr(first) + kReach, static_cast<ptrdiff_t>(to->step));
}

}  // namespace

void CutBand(const PyramidLevel& level, int index, SphereBand* band) {
  const int width = level.camera.width();
  const int height = level.camera.height();
  band->y_begin = index * height / kSphereBands;
  band->y_end = (index + 1) * height / kSphereBands;
  if (IsWhole(index)) {
    band->width = width;
    band->first_row = -kMarginY;
    band->padded = level.padded;
    return;
  }
  const double cells = width * CosineOfBand(index) / kSphereColumns;
  const int band_width = kSphereColumns * std::max(1, static_cast<int>(std::lround(cells)));
  if (band->compression.empty() || band->compression.front().source_size != width ||
      band->width != band_width) {
    band->compression = Steps(width, band_width);
  }
  band->width = band_width;
  band->first_row = band->y_begin - kMarginY;
  band->padded.create(band->y_end - band->y_begin + 2 * kMarginY, band->width + 2 * kMarginX,
                      CV_8U);
  Compress(level, band);
}

void BlurBand(int index, const SphereBand& band, cv::Mat* whole, SphereBand* blurred) {
  blurred->y_begin = band.y_begin;
  blurred->y_end = band.y_end;
  blurred->width = band.width;
  blurred->first_row = band.first_row;
  if (!IsWhole(index)) {
    blurred->padded.create(band.padded.size(), CV_8U);
    BlurRows(band.padded, kReach, band.padded.rows - kReach, &blurred->padded);
    return;
  }
  blurred->padded = *whole;
  // The outermost of these bands also blur the rows beyond them that patches reach.
  const int first = band.y_begin + (index == kFirstWhole ? kReach : kMarginY);
  const int last = band.y_end + kMarginY + (index == kLastWhole ? kMarginY - kReach : 0);
  BlurRows(band.padded, first, last, whole);
}

}  // namespace orb360
