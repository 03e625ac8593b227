#include "apps/town/sensor/sensor_noise.h"

#include <algorithm>
#include <cmath>

#include "apps/town/image/random.h"

namespace orb360::town {

void AddNoise(const SensorNoise& options, uint64_t seed, int frame, cv::Mat3f* image) {
  const Random frame_random = Random(seed).Fork(static_cast<uint64_t>(frame));
  const double read_variance = options.read_noise * options.read_noise;
#pragma omp parallel for schedule(static)
  for (int row = 0; row < image->rows; ++row) {
    Random random = frame_random.Fork(static_cast<uint64_t>(row));
    for (int column = 0; column < image->cols; ++column) {
      for (float& value : (*image)(row, column).val) {
        const double electrons = options.full_well * std::max(value, 0.0F);
        value += static_cast<float>(std::sqrt(electrons + read_variance) * random.Gaussian() /
                                    options.full_well);
      }
    }
  }
}

}  // namespace orb360::town
