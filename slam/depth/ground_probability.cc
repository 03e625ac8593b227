#include "slam/depth/ground_probability.h"

#include <cmath>

#include <orb360/slam/geometry/camera.h>

namespace orb360 {

std::optional<double> MeanGroundProbability(const DenseDepth& depth, const Eigen::Vector3d& up) {
  constexpr double kCosine = 0.5;  // of the angle from straight down
  if (depth.ground.empty()) return std::nullopt;
  const EquirectangularCamera camera(depth.ground.cols, depth.ground.rows);
  double sum = 0;
  double weights = 0;
  for (int y = 0; y < depth.ground.rows; ++y) {
    const double weight = std::cos(camera.AngleOfPixels(y + 0.5 - 0.5 * depth.ground.rows));
    for (int x = 0; x < depth.ground.cols; ++x) {
      if (camera.Bearing({x + 0.5, y + 0.5}).dot(up) > -kCosine) continue;
      sum += weight * depth.ground.at<float>(y, x);
      weights += weight;
    }
  }
  return sum / weights;
}

}  // namespace orb360
