#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// Adds noise to each channel of exposed radiance. Radiance L frees full_well * L electrons, whose
/// number has the variance full_well * L (photon noise) + read_noise^2. The result may be negative.
/// It depends only on seed and frame.
void AddNoise(const SensorNoise& options, uint64_t seed, int frame, cv::Mat3f* image);

}  // namespace orb360::town
