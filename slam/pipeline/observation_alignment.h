#pragma once

#include <optional>

#include "slam/map/map.h"
#include "slam/optimization/local_bundle_adjustment.h"

namespace orb360 {

/// Finds where keyframes show the landmarks of keyframe `id` more exactly than corners do: corners
/// are found for each image on its own, and move about by half a pixel; gray values that agree do
/// not.
///
/// A landmark without a patch gets that of the keyframe. What any image that is kept shows of a
/// landmark is aligned with its patch, once, as a plane whose slope is learned on the way: from
/// that of the ground, where it is given, for what lies on it. Observations that do not look like
/// the patch, lie near the poles or are seen from too far away stay as they are, and so does what
/// was aligned with a patch that a stored map has not kept.
void AlignObservations(KeyframeId id, const std::optional<KnownGround>& ground, Map* map);

}  // namespace orb360
