#include "apps/town/sequence/stage_exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/town/render/renderer.h"
#include "apps/town/sensor/auto_exposure.h"

namespace orb360::town {

double ExposureFor(const Stage& stage, std::span<const Rigid3> places) {
  constexpr double kBright = 0.92;    // fraction of the pixels that are no brighter than ...
  constexpr double kBrightest = 0.9;  // ... this radiance after exposure
  double sum = 0;
  std::vector<float> luminances;
  for (const Rigid3& place : places) {
    const cv::Mat3f image =
        RenderRadiance(stage.With({}), stage.shader(), EquirectangularCamera(64, 32), place);
    sum += std::log(MeteredRadiance(image));
    for (const cv::Vec3f& pixel : image) luminances.push_back(pixel[1]);
  }
  const auto bright =
      luminances.begin() + static_cast<int>(kBright * static_cast<double>(luminances.size()));
  std::nth_element(luminances.begin(), bright, luminances.end());
  const auto count = static_cast<double>(places.size());
  return std::min(AutoExposure().key / std::exp(sum / count),
                  kBrightest / std::max(1e-6F, *bright));
}

}  // namespace orb360::town
