#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/depth/sparse_depth.h"
#include "slam/geometry/camera.h"
#include "slam/pipeline/atlas.h"
#include "slam/pipeline/mapper.h"
#include "slam/pipeline/options.h"

namespace orb360 {

/// Takes a tracked frame into the map as a keyframe, beside tracking.
struct KeyframeMapping {
  ActiveMap active;
  std::span<const Map> finished;
  TrackedFrame frame;
  std::shared_ptr<const SpherePyramid> pyramid;  // of the frame's image
  std::optional<KnownGround> ground;             // as landmarks show it so far
  /// The camera of the image in the size in which it is to be completed, and that image (CV_8UC3);
  /// none and empty where it is not.
  std::optional<EquirectangularCamera> completed_camera = {};
  cv::Mat color = {};
};

/// What came of it.
struct MappedKeyframe {
  ActiveMap active;
  MapUpdate update = {};                   // `reference` is the new keyframe
  std::vector<SparsePoint> sparse = {};    // what it sees, where it is to be completed
  cv::Mat color = {};                      // as above
  std::optional<KnownGround> ground = {};  // as it sees it
  std::optional<Loop> loop = {};           // that it closes
};

MappedKeyframe MapKeyframe(KeyframeMapping job, const Options& options);

}  // namespace orb360
