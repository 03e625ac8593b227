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
/// Returns the id of the keyframe.
KeyframeId IntegrateKeyframe(const TrackedFrame& frame, std::shared_ptr<const SpherePyramid> image,
                             const MapperOptions& options, const std::optional<KnownGround>& ground,
                             Map* map);

}  // namespace orb360
