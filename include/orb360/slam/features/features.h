#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/features/sphere_grid.h>

namespace orb360 {

/// 256 binary comparisons.
using Descriptor = std::array<uint64_t, 4>;

struct Keypoint {
  Eigen::Vector2f pixel;  // continuous level-0 pixel, centre of the top-left pixel at (0.5, 0.5)
  float angle;            // orientation in the tangent plane, radians from east towards south
  float sigma;            // angular noise of the position, radians (one standard deviation)
  uint8_t level;          // of the pyramid
  uint8_t score;          // FAST score; 0 where a landmark's patch was found and no corner

  bool is_corner() const { return score > 0; }
};

using Color = std::array<uint8_t, 3>;  // red, green, blue

/// The features of one image; all arrays have the same length, index = feature. Corners come first.
struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<Eigen::Vector3d> bearings;  // unit vectors, camera frame
  std::vector<Descriptor> descriptors;
  std::vector<Color> colors;  // empty where the image had none
  // Computed by IndexFeatures:
  SphereGrid grid;           // over the bearings of corners
  std::vector<int> corners;  // the finest feature that shows the same corner, or itself

  int size() const { return static_cast<int>(keypoints.size()); }
};

}  // namespace orb360
