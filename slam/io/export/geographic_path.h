#pragma once

#include <span>
#include <string>
#include <vector>

#include "slam/io/positions/georeference.h"
#include "slam/io/sparse_model.h"

namespace orb360 {

/// Frames on Earth.
struct GeographicPath {
  std::vector<GeodeticPoint> places;  ///< Of each frame.
  std::vector<std::string> times;     ///< UTC of each frame, ISO 8601; empty where it is unknown.
};

/// Places frames on Earth. Throws UserError where this build has no PROJ.
GeographicPath PlaceFrames(std::span<const PosedFrame> frames, const Georeference& georeference);

/// Throws UserError for fewer than two frames, which make no line. `format` names it.
void RequireLine(std::span<const PosedFrame> frames, const std::string& format);

/// Returns latitude or longitude with nine decimals (0.1 mm), and a height with four, which XML
/// schemas want without an exponent.
std::string DegreesText(double degrees);
std::string HeightText(double metres);

/// Says what the heights of a path are measured from and what has placed it.
std::string DescribeOrigin(const Georeference& georeference);

}  // namespace orb360
