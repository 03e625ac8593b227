#pragma once

#include <opencv2/core.hpp>

#include "apps/town/sensor/radiance.h"
#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// Returns the mean of the images at the middles of equal parts of the time in which the shutter is
/// open, so that moving and turning objects are smeared according to their motion. Light is
/// averaged, not gray levels.
cv::Mat3f Blurred(const MotionBlur& options, double seconds, const RadianceAt& radiance);

}  // namespace orb360::town
