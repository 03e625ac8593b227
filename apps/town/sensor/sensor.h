#pragma once

#include <opencv2/core.hpp>

#include "apps/town/sensor/radiance.h"
#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// The picture, 8-bit BGR, that a camera takes at a time of the light that `picture` gives: motion
/// blur, lenses, exposure and noise in linear light, then the tone curve, then JPEG. Without any
/// effect it is what RenderColour gives. `meter` is asked for the light to expose for, where
/// exposure is automatic; panoramas of 64 x 32 pixels will do. `frame` tells the noise of one frame
/// from the next. The same bytes for any number of threads.
cv::Mat3b TakePicture(const SensorOptions& options, int frame, double seconds,
                      const RadianceAt& picture, const RadianceAt& meter);

}  // namespace orb360::town
