#pragma once

#include <opencv2/core.hpp>

#include "apps/town/sensor/radiance.h"
#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// Returns what a camera meters: the geometric mean over the sphere of a panorama's luminance (Rec.
/// 709). Unlike the arithmetic mean it is not dominated by the sun.
double MeteredRadiance(const cv::Mat3f& panorama);

/// Returns the factor on the radiance, a whole number of steps, that brings a metered radiance
/// nearest to the key.
double ExposureGain(const AutoExposure& options, double metered);

/// Returns the factor at a time. It is set at multiples of the period, from the panorama (a small
/// one is sufficient) that `meter` returns for that time, so that any frame can be made without
/// those before it.
double ExposureGainAt(const AutoExposure& options, double seconds, const RadianceAt& meter);

}  // namespace orb360::town
