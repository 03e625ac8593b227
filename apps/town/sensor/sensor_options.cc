#include "apps/town/sensor/sensor_options.h"

#include <sstream>

namespace orb360::town {

std::string Describe(const SensorOptions& options) {
  if (!options.HasEffects()) return "";
  std::ostringstream text;
  text << "sensor:\n";
  if (const auto& exposure = options.auto_exposure) {
    text << "  auto_exposure: {step: " << exposure->step << ", limit: " << exposure->limit
         << ", period: " << exposure->period << ", key: " << exposure->key << "}\n";
  }
  if (const auto& blur = options.motion_blur)
    text << "  motion_blur: {shutter: " << blur->shutter << ", moments: " << blur->moments << "}\n";
  if (const auto& lens = options.dual_lens) {
    text << "  dual_lens: {baseline: " << lens->baseline
         << ", exposure_difference: " << lens->exposure_difference
         << ", rim_loss: " << lens->rim_loss << ", overlap: " << lens->overlap << "}\n";
  }
  if (const auto& noise = options.noise) {
    text << "  noise: {full_well: " << noise->full_well << ", read_noise: " << noise->read_noise
         << ", seed: " << options.seed << "}\n";
  }
  if (options.jpeg_quality) text << "  jpeg_quality: " << *options.jpeg_quality << "\n";
  return text.str();
}

}  // namespace orb360::town
