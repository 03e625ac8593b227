#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A pixel of a frame that shows a point.
struct PointObservation {
  /// Continuous pixel of the panorama; the centre of the top-left pixel is (0.5, 0.5).
  Eigen::Vector2f pixel;
  int32_t point = 0;  ///< Index into SparseModel::points.
};

/// A frame with a pose.
struct PosedFrame {
  int index = 0;           ///< Index in the input, from 0.
  double timestamp = 0.0;  ///< Time by the input's clock, seconds.
  /// Number of its map. Poses of different maps are related only by the motion that was assumed
  /// between the maps.
  int map = 0;
  bool is_keyframe = false;
  /// Pose of the optical camera frame (x right, y down, z forward) in the world of written files (x
  /// forward, y left, z up at the first tracked camera).
  Rigid3 world_from_optical;
  /// What a keyframe observes, each point once. Empty for other frames.
  std::vector<PointObservation> observations;
};

/// A landmark.
struct ColoredLandmark {
  Eigen::Vector3d position;  ///< World of written files.
  Color color{};             ///< Red, green, blue.
};

/// What other programs need of a run: frames with poses, landmarks, and which keyframe observes
/// which landmark where. This is the content of `reconstruction.h5`
/// (docs/formats/reconstruction.md), in the frames of written files.
struct SparseModel {
  int width = 0;                        ///< Width of the images that were tracked, pixels.
  int height = 0;                       ///< Height of these images, pixels.
  std::vector<PosedFrame> frames;       ///< Ordered by index, each once.
  std::vector<ColoredLandmark> points;  ///< The landmarks.
};

}  // namespace orb360
