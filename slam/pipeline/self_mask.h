#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "slam/io/sequence.h"

namespace orb360 {

/// Mask (CV_8U, 0 = leave out) of what moves with the camera, found in the first seconds of an
/// input (static_region.h): images 0.2 s apart until there is evidence, 10 s at most.
/// `options` as for the run itself, `frame_rate` as the opened sequence says. Throws UserError like
/// OpenSequence.
cv::Mat FindSelfMask(const std::string& input, const SequenceOptions& options, double frame_rate);

}  // namespace orb360
