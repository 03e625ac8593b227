#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/pipeline/atlas.h"
#include "slam/pipeline/ground_motion.h"
#include "slam/pipeline/mapper.h"
#include <orb360/slam/depth/sparse_depth.h>
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/pipeline/options.h>

namespace orb360 {

/// A job that adds a tracked frame to the map as a keyframe, beside tracking.
struct KeyframeMapping {
  ActiveMap active;
  std::span<const Map> finished;
  TrackedFrame frame;
  std::shared_ptr<const SpherePyramid> pyramid;  ///< Image pyramid of the frame.
  std::optional<KnownGround> ground;             ///< The ground that has been seen so far.
  cv::Mat mask = {};  ///< What moves with the camera (CV_8U, 0: not used); may be empty.
  /// The camera and the image (CV_8UC3, BGR) in the size in which depth is completed. None and
  /// empty where it is not completed for mapping.
  std::optional<EquirectangularCamera> completed_camera = {};
  cv::Mat color = {};
};

/// The result of KeyframeMapping.
struct MappedKeyframe {
  ActiveMap active;
  MapUpdate update = {};  ///< Its `reference` is the new keyframe.
  /// The landmarks that the keyframe sees, for the camera in which it is completed.
  std::vector<SparsePoint> sparse = {};
  /// The image of KeyframeMapping.
  cv::Mat color = {};
  /// The ground with the new keyframe taken into account.
  std::optional<KnownGround> ground = {};
  /// Whether the map has to be scaled so that the camera's height over this ground becomes the
  /// true one.
  bool changes_unit = false;
  /// The camera's motion over the ground at the new keyframe.
  std::optional<GroundMotion> ground_motion = {};
  /// The loop that the keyframe closes.
  std::optional<Loop> loop = {};
};

MappedKeyframe MapKeyframe(KeyframeMapping job, const Options& options);

}  // namespace orb360
