#pragma once

#include <memory>
#include <optional>

#include "slam/features/sphere_pyramid.h"
#include "slam/map/ground.h"
#include "slam/map/map.h"
#include "slam/pipeline/mapper_options.h"
#include "slam/pipeline/tracked_frame.h"

namespace orb360 {

/// Takes a tracked frame into the map as a keyframe: its observations, culling of doubtful
/// landmarks, new ones by panoramic triangulation, fusion of duplicates with its neighbours,
/// alignment with the landmarks' patches and search for more of them where `image` is not null,
/// local bundle adjustment, culling of redundant keyframes. Returns the keyframe's id.
KeyframeId IntegrateKeyframe(const TrackedFrame& frame, std::shared_ptr<const SpherePyramid> image,
                             const MapperOptions& options, const std::optional<KnownGround>& ground,
                             Map* map);

}  // namespace orb360
