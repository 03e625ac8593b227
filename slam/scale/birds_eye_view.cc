#include "slam/scale/birds_eye_view.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "slam/features/sphere_pyramid.h"

namespace orb360 {
namespace {

constexpr float kMasked = -1.0f;  // as a gray value
// Gray levels: variance of the noise in one cell. Ground with less texture counts less.
constexpr float kNoiseVariance = 4.0f;

// Chooses the pyramid level whose pixels are as large as a cell of the ground looks.
class LevelChooser {
 public:
  LevelChooser(const SpherePyramid& image, double cell) {
    const double log_ratio = std::log(RangeAtLevelZero(1.0, 1));
    const double pixel = image.front().camera.AngleOfPixels(1.0);
    // The angle of a cell at distance d, heights of the camera, is the root of its solid angle:
    // cell / d^1.5. Half-way between two levels it is `angle`.
    for (size_t level = 0; level + 1 < image.size(); ++level) {
      const double angle = pixel * std::exp((static_cast<double>(level) + 0.5) * log_ratio);
      least_squared_distances_.push_back(std::pow(cell / angle, 4.0 / 3.0));
    }
  }

  size_t LevelAt(double squared_distance) const {
    size_t level = 0;
    while (level < least_squared_distances_.size() &&
           squared_distance <= least_squared_distances_[level]) {
      ++level;
    }
    return level;
  }

 private:
  std::vector<double> least_squared_distances_;  // From which a level is fine enough.
};

}  // namespace

BirdsEyeView LookDown(const SpherePyramid& image, const Eigen::Matrix3d& axes, const cv::Mat& mask,
                      double cell, int begin, int end, int half_width) {
  BirdsEyeView view{begin, end, half_width, {}};
  view.values.reserve(static_cast<size_t>(end - begin) * view.width());
  const EquirectangularCamera& camera = image.front().camera;
  const LevelChooser levels(image, cell);
  for (int i = begin; i < end; ++i) {
    for (int j = -half_width; j < half_width; ++j) {
      const Eigen::Vector3d point((i + 0.5) * cell, (j + 0.5) * cell, -1.0);
      const Eigen::Vector2d on_level_0 = camera.Project(axes * point);
      if (!mask.empty() &&
          mask.at<uint8_t>(std::min(static_cast<int>(on_level_0.y()), mask.rows - 1),
                           std::min(static_cast<int>(on_level_0.x()), mask.cols - 1)) == 0) {
        view.values.push_back(kMasked);
        continue;
      }
      const size_t level = levels.LevelAt(point.squaredNorm());
      const EquirectangularCamera& of_level = image[level].camera;
      const double u = on_level_0.x() * of_level.width() / camera.width();
      const double v = on_level_0.y() * of_level.height() / camera.height();
      view.values.push_back(
          SampleBilinear(image[level], static_cast<float>(u), static_cast<float>(v)));
    }
  }
  return view;
}

BirdsEyeView JoinCells(int count, const BirdsEyeView& fine) {
  BirdsEyeView coarse{fine.begin / count, fine.end / count, fine.half_width / count, {}};
  for (int i = coarse.begin; i < coarse.end; ++i) {
    for (int j = -coarse.half_width; j < coarse.half_width; ++j) {
      float sum = 0;
      bool is_masked = false;
      for (int k = 0; k < count * count; ++k) {
        const float value = *fine.At(count * i + k / count, count * j + k % count);
        is_masked |= value == kMasked;
        sum += value;
      }
      coarse.values.push_back(is_masked ? kMasked : sum / (count * count));
    }
  }
  return coarse;
}

void NormalizeLocally(int radius, BirdsEyeView* view) {
  const cv::Mat gray(view->end - view->begin, view->width(), CV_32F, view->values.data());
  const cv::Mat is_seen = gray != kMasked;
  cv::Mat seen;
  is_seen.convertTo(seen, CV_32F, 1.0 / 255);
  const cv::Mat values = gray.mul(seen);
  const cv::Size box(2 * radius + 1, 2 * radius + 1);
  cv::Mat weight, mean, square;
  cv::boxFilter(seen, weight, CV_32F, box);
  cv::boxFilter(values, mean, CV_32F, box);
  cv::boxFilter(values.mul(values), square, CV_32F, box);
  for (int row = 0; row < gray.rows; ++row) {
    float* to = &view->values[static_cast<size_t>(row) * gray.cols];
    for (int column = 0; column < gray.cols; ++column) {
      const float sum = weight.at<float>(row, column);
      if (to[column] == kMasked || sum < 0.5f) {
        to[column] = 0;
        continue;
      }
      const float center = mean.at<float>(row, column) / sum;
      const float variance = std::max(0.0f, square.at<float>(row, column) / sum - center * center);
      to[column] = (to[column] - center) / std::sqrt(variance + kNoiseVariance);
    }
  }
}

}  // namespace orb360
