#pragma once

#include <string>

#include <opencv2/core.hpp>

#include <orb360/slam/io/sequence.h>

namespace orb360 {

/// Returns the mask (CV_8U, 0 where features are left out) of everything that moves with the
/// camera, found at the start of an input (static_region.h). It looks at images 0.2 s apart until
/// there is evidence, for at most 10 s. `options` are those of the run, `frame_rate` (1/s) is that
/// of the opened sequence. Throws UserError as OpenSequence does.
cv::Mat FindSelfMask(const std::string& input, const SequenceOptions& options, double frame_rate);

}  // namespace orb360
