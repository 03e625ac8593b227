#include "slam/io/lenses/sphere_stitcher.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "slam/io/lenses/exposure.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

/// Columns of the image of overlapping pixels: cv::remap takes no more than 16 bits for a side.
constexpr int kOverlapColumns = 1024;

/// Index of the image of pixels that no image shows.
constexpr std::uint8_t kNoImage = 255;

/// The pixel of a sample in the images one below the other, for cv::remap, whose pixel centres are
/// integers. It stays inside of its image, also with interpolation.
cv::Vec2f StackedPixel(const StitchSample& sample, cv::Size size, int first_row) {
  const double x = std::clamp(sample.x - 0.5, 0.0, size.width - 1.0);
  const double y = std::clamp(sample.y - 0.5, 0.0, size.height - 1.0);
  return {static_cast<float>(x), static_cast<float>(y + first_row)};
}

}  // namespace

SphereStitcher::SphereStitcher(cv::Size sphere, std::vector<cv::Size> images,
                               const StitchSampler& sampler)
    : sphere_(sphere), sizes_(std::move(images)), image_(sphere, CV_8U, cv::Scalar(kNoImage)) {
  std::vector<int> first_row = {0};
  for (const cv::Size& size : sizes_) first_row.push_back(first_row.back() + size.height);
  ORB360_CHECK(first_row.back() <= kMaxStitchedSide && sphere.width <= kMaxStitchedSide,
               first_row.back(), sphere);
  const EquirectangularCamera camera(sphere.width, sphere.height);
  cv::Mat map(sphere, CV_32FC2, cv::Scalar(-1, -1));
  std::vector<cv::Vec2f> overlap_pixels;
  std::vector<StitchSample> samples;
  for (int row = 0; row < sphere.height; ++row) {
    for (int col = 0; col < sphere.width; ++col) {
      samples.clear();
      sampler(camera.Bearing({col + 0.5, row + 0.5}), &samples);
      if (samples.empty()) continue;
      ORB360_CHECK(samples.size() <= 2, samples.size());
      std::ranges::stable_sort(samples, std::greater<>(), &StitchSample::weight);
      const auto pixel = [&](const StitchSample& sample) {
        return StackedPixel(sample, sizes_[sample.image], first_row[sample.image]);
      };
      map.at<cv::Vec2f>(row, col) = pixel(samples[0]);
      image_.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(samples[0].image);
      if (samples.size() < 2 || samples[1].weight <= 0.0) continue;
      overlap_.push_back(row * sphere.width + col);
      overlap_pixels.push_back(pixel(samples[1]));
      overlap_weight_.push_back(static_cast<int>(
          256.0 * samples[1].weight / (samples[0].weight + samples[1].weight) + 0.5));
      overlap_image_.push_back(static_cast<std::uint8_t>(samples[1].image));
    }
  }
  cv::convertMaps(map, {}, map_, map_fraction_, CV_16SC2);
  if (!overlap_.empty()) {
    const int rows = static_cast<int>((overlap_.size() - 1) / kOverlapColumns) + 1;
    overlap_pixels.resize(static_cast<size_t>(rows) * kOverlapColumns);
    const cv::Mat pixels(rows, kOverlapColumns, CV_32FC2, overlap_pixels.data());
    cv::convertMaps(pixels, {}, overlap_map_, overlap_fraction_, CV_16SC2);
  }
  if (cv::countNonZero(image_ == kNoImage) > 0) coverage_ = image_ != kNoImage;
}

cv::Mat SphereStitcher::Stitch(std::span<const cv::Mat> images, bool matches_exposure) const {
  ORB360_CHECK(images.size() == sizes_.size(), images.size(), sizes_.size());
  for (size_t i = 0; i < images.size(); ++i) {
    ORB360_CHECK(images[i].size() == sizes_[i] && images[i].type() == CV_8UC3, i);
  }
  cv::Mat stacked;
  cv::vconcat(images.data(), images.size(), stacked);
  cv::Mat sphere;
  cv::remap(stacked, sphere, map_, map_fraction_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  if (overlap_.empty()) return sphere;
  cv::Mat second;
  cv::remap(stacked, second, overlap_map_, overlap_fraction_, cv::INTER_LINEAR,
            cv::BORDER_CONSTANT);
  auto* const pixels = sphere.ptr<cv::Vec3b>();
  auto* const seconds = second.ptr<cv::Vec3b>();
  const std::uint8_t* const image = image_.ptr<std::uint8_t>();
  const int count = static_cast<int>(overlap_.size());
  if (matches_exposure) {
    ExposureMatch match;
    for (int i = 0; i < count; ++i) {
      const int first_image = image[overlap_[i]];
      if (first_image == overlap_image_[i]) continue;
      const bool is_swapped = first_image > overlap_image_[i];
      const cv::Vec3b& a = pixels[overlap_[i]];
      is_swapped ? match.Add(seconds[i], a) : match.Add(a, seconds[i]);
    }
    const std::array<ValueTable, 2> tables = match.Tables();
    cv::parallel_for_({0, sphere.rows}, [&](const cv::Range& rows) {
      for (int at = rows.start * sphere.cols; at < rows.end * sphere.cols; ++at) {
        if (image[at] < 2) ApplyTable(tables[image[at]], &pixels[at]);
      }
    });
    for (int i = 0; i < count; ++i) ApplyTable(tables[overlap_image_[i]], &seconds[i]);
  }
  for (int i = 0; i < count; ++i) {
    cv::Vec3b& pixel = pixels[overlap_[i]];
    for (int channel = 0; channel < 3; ++channel) {
      const int difference = seconds[i][channel] - pixel[channel];
      pixel[channel] =
          static_cast<uchar>(pixel[channel] + ((overlap_weight_[i] * difference + 128) >> 8));
    }
  }
  return sphere;
}

}  // namespace orb360
