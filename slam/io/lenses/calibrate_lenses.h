#pragma once

#include <string>

#include "slam/io/lenses/lens_estimation.h"

namespace orb360 {

/// Finds the calibration of the two lenses of a camera from what both show, in up to 12 frames
/// spread over a video or a folder of images, starting from a calibration that is right to 3
/// degrees. Throws UserError if the recording does not fit it, or shows too little in both lenses.
LensEstimate CalibrateLenses(const std::string& recording, const LensCalibration& start);

}  // namespace orb360
