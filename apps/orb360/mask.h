#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core.hpp>

#include <orb360/slam/io/sequence.h>

namespace orb360 {

/// Reads a mask image, which is black where features are excluded, and scales it to `size`. The
/// result is CV_8UC1: 0 where the image is darker than half of the full brightness, 255 elsewhere.
/// Throws UserError if the image cannot be read or is not a full sphere.
cv::Mat LoadMask(const std::string& file, cv::Size size);

/// Returns the mask for the argument of --mask. `auto` searches everything that moves with the
/// camera at the start of `input` (FindSelfMask); for a rendered input it gives an empty mask, as
/// `none` does. Everything else is the name of a mask image. What the input does not show of the
/// sphere is left out as well, whatever the choice. `sequence` is the input as opened with
/// `options`.
cv::Mat ChooseMask(const std::string& choice, const std::string& input,
                   const SequenceOptions& options, const Sequence& sequence);

/// Name of the mask in the folder of a run.
inline constexpr const char* kMaskName = "mask.png";

/// Writes the mask of a run into its folder, so that exporters know it. An empty mask leaves no
/// file there, not even that of an earlier run. Throws UserError.
void SaveMask(const std::filesystem::path& folder, const cv::Mat& mask);

/// Returns the fraction of the sphere's solid angle that a mask excludes; 0 for an empty mask.
double ExcludedFraction(const cv::Mat& mask);

}  // namespace orb360
