#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "slam/io/lenses/fisheye_lens.h"
#include "slam/io/lenses/sphere_stitcher.h"

namespace orb360 {

/// The two lenses of a camera and how their images come.
struct LensCalibration {
  /// Both images lie beside each other in one video track, the first lens on the left. Otherwise
  /// each lens has a track or a file of its own.
  bool is_side_by_side = false;
  /// Distance at which both lenses are made to agree, metres; 0: infinity. It matters only if the
  /// lenses have positions.
  double distance = 0.0;
  std::array<FisheyeLens, 2> lenses;
};

/// Reads a calibration file (docs/formats/lens_calibration.md). Throws UserError that names file
/// and line for anything that is missing, unknown or out of range.
LensCalibration ReadLensCalibration(const std::filesystem::path& file);

/// Returns the content of a calibration file.
std::string ToYaml(const LensCalibration& calibration);

/// Names of the calibrations that come with the program, for messages and help.
std::vector<std::string> LensPresetNames();

/// Returns the calibration for what a user has given: the name of a preset, or else a file. Throws
/// UserError.
LensCalibration FindLensCalibration(const std::string& name_or_file);

/// Returns the calibration for images of the given sizes. Throws UserError, whose message begins
/// with `name`, where they have other proportions.
LensCalibration ScaledTo(const LensCalibration& calibration, const std::vector<cv::Size>& sizes,
                         const std::string& name);

/// Size of the full sphere with the resolution of the lenses.
cv::Size SphereSize(const LensCalibration& calibration);

/// Gives for a direction its samples in the images of both lenses. They are blended
/// within a degree on either side of where both are equally far from their axes.
StitchSampler DualFisheyeSampler(const LensCalibration& calibration);

}  // namespace orb360
