#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "slam/io/sequence.h"

namespace orb360 {

/// Reads a mask image, black where features are not wanted, and scales it to `size`: CV_8UC1, 0
/// for excluded (darker than half), 255 for the rest. Throws UserError if it cannot be read or is
/// no full sphere.
cv::Mat LoadMask(const std::string& file, cv::Size size);

/// The mask that --mask asks for: `auto` looks for what moves with the camera at the start of
/// `input` (FindSelfMask), in a rendered one for nothing; `none` is an empty mask, all else is an
/// image's name. `sequence` is the input as opened with `options`.
cv::Mat ChooseMask(const std::string& choice, const std::string& input,
                   const SequenceOptions& options, const Sequence& sequence);

/// The fraction of the sphere that a mask excludes; 0 for an empty one.
double ExcludedFraction(const cv::Mat& mask);

}  // namespace orb360
