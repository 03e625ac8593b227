#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/features/sphere_grid.h>

namespace orb360 {

/// Binary descriptor of a feature: the results of 256 comparisons of gray values in the tangent
/// plane (docs/concepts/features.md). Descriptors are compared by their Hamming distance.
using Descriptor = std::array<uint64_t, 4>;

/// Position and appearance of a feature in the image.
struct Keypoint {
  /// Continuous pixel of the image (level 0); the centre of the top-left pixel is (0.5, 0.5).
  Eigen::Vector2f pixel;
  float angle;    ///< Orientation in the tangent plane, radians from east towards south.
  float sigma;    ///< Standard deviation of the direction (angular noise), radians.
  uint8_t level;  ///< Pyramid level, from 0; each is smaller by a factor of 2^(1/4).
  uint8_t score;  ///< FAST score, gray levels; 0 for a landmark's patch that is no corner.

  /// Returns whether FAST found the feature; else it was found by aligning a landmark's patch.
  bool is_corner() const { return score > 0; }
};

/// Red, green and blue, 0 to 255.
using Color = std::array<uint8_t, 3>;

/// The features of one image. All arrays have the same length and are indexed by feature; corners
/// come first. IndexFeatures computes `grid` and `corners` from the keypoints and bearings.
struct Features {
  std::vector<Keypoint> keypoints;        ///< Positions in the image.
  std::vector<Eigen::Vector3d> bearings;  ///< Unit vectors, camera frame.
  std::vector<Descriptor> descriptors;    ///< Binary descriptors.
  std::vector<Color> colors;  ///< Colours of the pixels; empty where the image had none.
  SphereGrid grid;            ///< Index of the bearings of corners.
  /// For each feature the feature on the finest level that shows the same corner; the feature
  /// itself where no finer one does.
  std::vector<int> corners;

  /// Returns the number of features.
  int size() const { return static_cast<int>(keypoints.size()); }
};

}  // namespace orb360
