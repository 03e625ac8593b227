#include "slam/io/export/view_resampler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/io/optical_frame.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

/// Number of pixels by which the panorama is continued on each side: what cubic weights reach.
constexpr int kMargin = 2;

/// Returns rows shifted by half of the width: how the sphere goes on beyond a pole.
cv::Mat OppositeRows(const cv::Mat& rows) {
  cv::Mat opposite;
  const int half = rows.cols / 2;
  cv::hconcat(rows.colRange(half, rows.cols), rows.colRange(0, half), opposite);
  return opposite;
}

/// Continues a panorama by kMargin pixels on each side as the sphere goes on.
cv::Mat Padded(const cv::Mat& panorama) {
  cv::Mat top;
  cv::Mat bottom;
  cv::flip(OppositeRows(panorama.rowRange(0, kMargin)), top, 0);
  cv::flip(OppositeRows(panorama.rowRange(panorama.rows - kMargin, panorama.rows)), bottom, 0);
  const cv::Mat parts[] = {top, panorama, bottom};
  cv::Mat padded;
  cv::vconcat(parts, 3, padded);
  cv::copyMakeBorder(padded, padded, 0, 0, kMargin, kMargin, cv::BORDER_WRAP);
  return padded;
}

/// Returns the pixel of an image of `size` that shows a pixel of a view, given by its column and
/// row.
Eigen::Vector2d SourceOf(const View& view, const EquirectangularCamera& camera, int column,
                         int row) {
  return camera.Project(CameraFromOptical() * DirectionOfPixel(view, {column + 0.5, row + 0.5}));
}

}  // namespace

ViewResampler::ViewResampler(cv::Size panorama_size, std::vector<View> views)
    : size_(panorama_size), views_(std::move(views)) {
  ORB360_CHECK(size_.width >= 2 * kMargin && size_.height >= 2 * kMargin, size_);
  const EquirectangularCamera camera(size_.width, size_.height);
  for (const View& view : views_) {
    cv::Mat coordinates;
    cv::Mat fractions;
    if (!view.is_panorama()) {
      cv::Mat map(view.height, view.width, CV_32FC2);
#pragma omp parallel for
      for (int row = 0; row < view.height; ++row) {
        auto* to = map.ptr<cv::Vec2f>(row);
        for (int column = 0; column < view.width; ++column) {
          // OpenCV's pixels have their centres at integers.
          const Eigen::Vector2d pixel = SourceOf(view, camera, column, row).array() + kMargin - 0.5;
          to[column] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
        }
      }
      cv::convertMaps(map, cv::Mat(), coordinates, fractions, CV_16SC2);
    }
    coordinates_.push_back(coordinates);
    fractions_.push_back(fractions);
  }
}

cv::Mat ViewResampler::Resample(const cv::Mat& panorama, size_t v) const {
  ORB360_CHECK(panorama.size() == size_, panorama.size(), size_);
  if (views_[v].is_panorama()) return panorama;
  cv::Mat image;
  cv::remap(Padded(panorama), image, coordinates_[v], fractions_[v], cv::INTER_CUBIC,
            cv::BORDER_REPLICATE);
  return image;
}

cv::Mat ViewResampler::ResampleNearest(const cv::Mat& image, size_t v) const {
  const View& view = views_[v];
  if (view.is_panorama()) {
    cv::Mat resized;
    cv::resize(image, resized, {view.width, view.height}, 0, 0, cv::INTER_NEAREST);
    return resized;
  }
  const EquirectangularCamera camera(image.cols, image.rows);
  cv::Mat nearest(view.height, view.width, image.type());
  const size_t bytes = image.elemSize();
#pragma omp parallel for
  for (int row = 0; row < view.height; ++row) {
    for (int column = 0; column < view.width; ++column) {
      const Eigen::Vector2d pixel = SourceOf(view, camera, column, row);
      const int x = std::min(static_cast<int>(pixel.x()), image.cols - 1);
      const int y = std::min(static_cast<int>(pixel.y()), image.rows - 1);
      std::copy_n(image.ptr(y, x), bytes, nearest.ptr(row, column));
    }
  }
  return nearest;
}

}  // namespace orb360
