#pragma once

#include <opencv2/core.hpp>

#include "apps/town/sensor/radiance.h"
#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// The mean of the pictures at the middles of equal parts of the time in which the shutter is
/// open: what moves or turns, near or far, is smeared as it should be. Averages light, not grey
/// levels.
cv::Mat3f Blurred(const MotionBlur& options, double seconds, const RadianceAt& picture);

}  // namespace orb360::town
