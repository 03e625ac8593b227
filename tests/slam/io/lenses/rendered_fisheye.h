#pragma once

#include <functional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "slam/io/lenses/fisheye_lens.h"

namespace orb360 {

/// The image of a fisheye lens of a sphere that lies far away and has `color_of` a direction in the
/// camera frame (-X forward, +Y right, +Z up), black outside of the field of view. The angle for a
/// radius is looked up in a table of radii, so that nothing but the model's formula is shared.
cv::Mat RenderFisheye(const FisheyeLens& lens,
                      const std::function<cv::Vec3b(const Eigen::Vector3d&)>& color_of);

/// A sphere with fine texture everywhere, which is different in every direction.
class TexturedSphere {
 public:
  explicit TexturedSphere(unsigned seed);
  cv::Vec3b operator()(const Eigen::Vector3d& bearing) const;

 private:
  cv::Mat noise_;  // of a cube, in slices one below the other, CV_8UC3
};

}  // namespace orb360
