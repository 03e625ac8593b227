#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// Adds noise to each channel of exposed radiance: radiance L frees full_well * L electrons, whose
/// number has a variance of full_well * L (photon noise) + read_noise^2. The result may be
/// negative. The same for a seed and frame, whatever was made before.
void AddNoise(const SensorNoise& options, uint64_t seed, int frame, cv::Mat3f* image);

}  // namespace orb360::town
