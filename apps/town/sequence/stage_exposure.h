#pragma once

#include <span>

#include "apps/town/render/stage.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360::town {

/// Returns the factor on all radiance with which images from these places (world_from_camera) are
/// well exposed on the whole: the key of AutoExposure for their geometric mean, or less where more
/// than a twelfth of the pixels would be nearly saturated.
double ExposureFor(const Stage& stage, std::span<const Rigid3> places);

}  // namespace orb360::town
