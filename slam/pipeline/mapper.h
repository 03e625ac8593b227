#pragma once

#include <memory>
#include <optional>

#include "slam/features/sphere_pyramid.h"
#include "slam/pipeline/tracked_frame.h"
#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/mapper_options.h>

namespace orb360 {

/// Adds a tracked frame to the map as a keyframe. The steps are: adding its observations, culling
/// of doubtful landmarks, panoramic triangulation of new ones, fusion of duplicates with
/// neighbouring keyframes, alignment with the patches of landmarks and search for further landmarks
/// (both where `image` is not null), local bundle adjustment, and culling of redundant keyframes.
/// Returns the id of the keyframe. `ground`: as it is known so far. `ground_mask`: what moves with
/// the camera, where steps over the ground are to be measured (MeasureGroundSteps).
KeyframeId IntegrateKeyframe(const TrackedFrame& frame, std::shared_ptr<const SpherePyramid> image,
                             const MapperOptions& options, const std::optional<KnownGround>& ground,
                             const std::optional<cv::Mat>& ground_mask, Map* map);

}  // namespace orb360
