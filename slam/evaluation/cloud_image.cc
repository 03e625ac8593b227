#include "slam/evaluation/cloud_image.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <opencv2/imgproc.hpp>

#include "slam/evaluation/chart.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Margin around the path, as a fraction of its larger extent, and its least size in metres, that
/// of a room.
constexpr double kMargin = 0.12;
constexpr double kMinMargin = 8.0;
/// Size of the cells of ground that have a common camera height, as a fraction of the image's
/// larger extent.
constexpr double kHeightCell = 1.0 / 256.0;
const cv::Scalar kGround(26, 22, 20);
const cv::Scalar kPath(60, 140, 255);

/// Number of passes that fill gaps where points are farther apart than pixels. Gaps of up to twice
/// this number of pixels are closed.
constexpr int kFillPasses = 2;
/// Least number of known pixels among the eight around a pixel that is filled, so that single
/// points stay points.
constexpr int kMinKnownAround = 3;

/// Sets unknown pixels among known ones to their mean.
void FillGaps(cv::Mat* image, cv::Mat* is_known) {
  const cv::Mat before = image->clone();
  const cv::Mat known = is_known->clone();
  for (int row = 1; row + 1 < image->rows; ++row) {
    for (int column = 1; column + 1 < image->cols; ++column) {
      if (known.at<std::uint8_t>(row, column) != 0) continue;
      cv::Vec3i sum;
      int count = 0;
      for (int y = row - 1; y <= row + 1; ++y) {
        for (int x = column - 1; x <= column + 1; ++x) {
          if (known.at<std::uint8_t>(y, x) == 0) continue;
          sum += cv::Vec3i(before.at<cv::Vec3b>(y, x));
          ++count;
        }
      }
      if (count < kMinKnownAround) continue;
      image->at<cv::Vec3b>(row, column) = cv::Vec3b(sum / count);
      is_known->at<std::uint8_t>(row, column) = 1;
    }
  }
}

/// Returns 1, 2 or 5 times a power of ten that is not longer than `length`.
double RoundLength(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  const double digit = length / power;
  return power * (digit >= 5.0 ? 5.0 : digit >= 2.0 ? 2.0 : 1.0);
}

}  // namespace

CloudImage::CloudImage(std::span<const Eigen::Vector3d> path, int side)
    : path_(path.begin(), path.end()) {
  ORB360_CHECK(!path_.empty() && side > 0, path_.size(), side);
  for (const Eigen::Vector3d& position : path_) box_.extend(position.head<2>());
  const double margin = std::max(kMargin * box_.sizes().maxCoeff(), kMinMargin);
  box_ = {box_.min().array() - margin, box_.max().array() + margin};
  pixels_per_unit_ = side / box_.sizes().maxCoeff();
  size_ = cv::Size(static_cast<int>(std::ceil(box_.sizes().x() * pixels_per_unit_)),
                   static_cast<int>(std::ceil(box_.sizes().y() * pixels_per_unit_)));
  pixels_.assign(static_cast<size_t>(size_.area()),
                 {-std::numeric_limits<float>::infinity(), cv::Vec3b()});
}

Eigen::Vector2d CloudImage::ToPixel(const Eigen::Vector2d& position) const {
  return {(position.x() - box_.min().x()) * pixels_per_unit_,
          (box_.max().y() - position.y()) * pixels_per_unit_};
}

double CloudImage::CameraHeight(const Eigen::Vector2f& position) {
  const double cell_size = kHeightCell * box_.sizes().maxCoeff();
  const std::pair cell(static_cast<int>(std::floor(position.x() / cell_size)),
                       static_cast<int>(std::floor(position.y() / cell_size)));
  const auto [found, is_new] = height_of_cell_.try_emplace(cell, 0.0);
  if (is_new) {
    const Eigen::Vector2d centre(cell_size * (cell.first + 0.5), cell_size * (cell.second + 0.5));
    const auto nearest = std::ranges::min_element(
        path_, {}, [&](const Eigen::Vector3d& p) { return (p.head<2>() - centre).squaredNorm(); });
    found->second = nearest->z();
  }
  return found->second;
}

void CloudImage::Add(std::span<const SurfacePoint> points) {
  for (const SurfacePoint& point : points) {
    const Eigen::Vector2d at = ToPixel(point.position.head<2>().cast<double>());
    if (!(at.x() >= 0 && at.x() < size_.width && at.y() >= 0 && at.y() < size_.height)) continue;
    if (point.position.z() > CameraHeight(point.position.head<2>())) continue;
    Pixel& pixel = pixels_[static_cast<size_t>(at.y()) * static_cast<size_t>(size_.width) +
                           static_cast<size_t>(at.x())];
    if (point.position.z() > pixel.height) {
      pixel = {point.position.z(), {point.rgb[2], point.rgb[1], point.rgb[0]}};
    }
  }
}

cv::Mat CloudImage::Draw(bool is_metric) const {
  cv::Mat image(size_, CV_8UC3, kGround);
  cv::Mat is_known(size_, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < size_.height; ++row) {
    for (int column = 0; column < size_.width; ++column) {
      const Pixel& pixel = pixels_[static_cast<size_t>(row) * static_cast<size_t>(size_.width) +
                                   static_cast<size_t>(column)];
      if (!std::isfinite(pixel.height)) continue;
      image.at<cv::Vec3b>(row, column) = pixel.bgr;
      is_known.at<std::uint8_t>(row, column) = 1;
    }
  }
  for (int pass = 0; pass < kFillPasses; ++pass) FillGaps(&image, &is_known);
  std::vector<cv::Point> line;
  for (const Eigen::Vector3d& position : path_) {
    const Eigen::Vector2d at = ToPixel(position.head<2>());
    line.emplace_back(static_cast<int>(at.x()), static_cast<int>(at.y()));
  }
  cv::polylines(image, line, /*isClosed=*/false, kPath, 2, cv::LINE_AA);
  cv::circle(image, line.front(), 7, kPath, 2, cv::LINE_AA);

  const double length = RoundLength(0.2 * size_.width / pixels_per_unit_);
  const int pixels = static_cast<int>(std::lround(length * pixels_per_unit_));
  const cv::Point left(20, size_.height - 20);
  const cv::Scalar white = cv::Scalar::all(255);
  cv::rectangle(image, left + cv::Point(-8, -34), left + cv::Point(pixels + 8, 8), kGround,
                cv::FILLED);
  cv::line(image, left, left + cv::Point(pixels, 0), white, 3);
  std::string label = Decimal(length, length < 1.0 ? 2 : 0);
  label += is_metric ? " m" : " units";
  cv::putText(image, label, left + cv::Point(0, -10), cv::FONT_HERSHEY_SIMPLEX, 0.6, white, 1,
              cv::LINE_AA);
  return image;
}

}  // namespace orb360
