#pragma once

#include <optional>
#include <string>

#include "slam/io/lenses/lens_calibration.h"

namespace orb360 {

/// Returns the calibration of that name, for a camera model as its lenses are specified, or
/// nullopt. Each camera differs from it by some pixels and tenths of a degree, which
/// CalibrateLenses finds.
std::optional<LensCalibration> LensPreset(const std::string& name);

}  // namespace orb360
