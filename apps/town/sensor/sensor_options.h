#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace orb360::town {

/// Exposure that follows the light in steps, as cameras do.
struct AutoExposure {
  double step = 1.0 / 3;  ///< stops (factors of 2) between exposures
  double limit = 2;       ///< stops that the exposure may be raised or lowered
  double period = 0.5;    ///< seconds from one metering to the next
  double key = 0.29;      ///< metered radiance (see MeteredRadiance) that needs no correction
};

/// Objects that move while the shutter is open are smeared.
struct MotionBlur {
  double shutter = 0.01;  ///< seconds, half before and half after the frame's time
  int moments = 4;        ///< renderings that are averaged
};

/// Traces, in a panorama, of the two fisheye lenses back to back from which it was stitched. One
/// looks forward, the other backward; the seam is the circle between them.
struct DualLens {
  double baseline = 0.03;             ///< metres between the lenses: things at the seam are doubled
  double exposure_difference = 0.15;  ///< stops by which the front image is brighter
  double rim_loss = 0.1;              ///< fraction of the light lost 90 degrees off a lens's axis
  double overlap = 0.07;              ///< radians over which one image blends into the other
};

/// Photon noise and read noise.
struct SensorNoise {
  double full_well = 4000;  ///< electrons that radiance 1 (a white wall in the sun) sets free
  double read_noise = 5;    ///< electrons, standard deviation
};

/// The effects of a camera on an image. All are off by default.
struct SensorOptions {
  std::optional<AutoExposure> auto_exposure;
  std::optional<MotionBlur> motion_blur;
  std::optional<DualLens> dual_lens;
  std::optional<SensorNoise> noise;
  std::optional<int> jpeg_quality;  ///< 1 to 100
  uint64_t seed = 0;                ///< of the noise

  bool HasEffects() const {
    return auto_exposure || motion_blur || dual_lens || noise || jpeg_quality;
  }
};

/// Returns the active effects with all their parameters as lines of YAML; empty without any.
std::string Describe(const SensorOptions& options);

}  // namespace orb360::town
