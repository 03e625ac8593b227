#pragma once

#include <optional>

#include "slam/optimization/local_bundle_adjustment.h"
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Measures the observations of the landmarks of keyframe `id` more accurately than corners do.
/// Corners are found in each image separately, so that their positions differ by about half a
/// pixel; the alignment of gray values does not have this error.
///
/// A landmark without a patch gets the patch of the keyframe. Each observation in a keyframe whose
/// image is kept is aligned with the patch once. The patch is taken as a plane, whose slope is
/// estimated along with the positions; for landmarks on the ground the estimate starts from the
/// slope of the ground, where that is given. Observations that do not look like the patch, lie near
/// the poles or are seen from too far away do not change, nor do those that were aligned with a
/// patch that a stored map does not contain.
void AlignObservations(KeyframeId id, const std::optional<KnownGround>& ground, Map* map);

}  // namespace orb360
