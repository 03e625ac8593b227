#pragma once

#include <opencv2/core.hpp>

#include "apps/town/sensor/radiance.h"
#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// Returns the image, 8-bit BGR, that a camera takes at a time of the light that `radiance`
/// returns: motion blur, lenses, exposure and noise in linear light, then the tone curve, then
/// JPEG. Without any effect it is the result of RenderColour. With automatic exposure, `meter` is
/// asked for the light to expose for; panoramas of 64 x 32 pixels are sufficient. `frame` makes the
/// noise of one frame different from the next. The bytes are the same for any number of threads.
cv::Mat3b CaptureImage(const SensorOptions& options, int frame, double seconds,
                       const RadianceAt& radiance, const RadianceAt& meter);

}  // namespace orb360::town
