#pragma once

#include "slam/map/map.h"

namespace orb360 {

/// Finds where a keyframe shows its landmarks more exactly than corners do: corners are found for
/// each picture on its own, and move about by half a pixel; gray values that agree do not.
///
/// A landmark without a patch gets that of the keyframe, and what other keyframes show of it is
/// aligned with it; for the others the keyframe's own observation is aligned. The surface is taken
/// to face the camera that the patch is from. Observations that do not look like the patch, whose
/// picture is not kept, that lie near the poles or are seen from too far away stay as they are, and
/// so does what was aligned with a patch that a stored map has not kept.
void AlignObservations(KeyframeId id, Map* map);

}  // namespace orb360
