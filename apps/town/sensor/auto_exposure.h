#pragma once

#include <opencv2/core.hpp>

#include "apps/town/sensor/radiance.h"
#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// What a camera meters: the geometric mean over the sphere of a panorama's luminance (Rec. 709).
/// Unlike the plain mean it is not led by the sun.
double MeteredRadiance(const cv::Mat3f& panorama);

/// The factor on the radiance, a whole number of steps, that brings a metered radiance nearest to
/// the key.
double ExposureGain(const AutoExposure& options, double metered);

/// The factor at a time. It is set at multiples of the period, from what `meter` shows then (a
/// small panorama will do), so that any frame can be made without those before it.
double ExposureGainAt(const AutoExposure& options, double seconds, const RadianceAt& meter);

}  // namespace orb360::town
