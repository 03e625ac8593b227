#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "slam/io/lenses/sphere_stitcher.h"

namespace orb360 {

/// Equi-angular cube faces as GoPro's cameras store them in a `.360` file: two video tracks, three
/// faces beside each other in each.
///
/// The first track shows left, front and right. The second shows, each turned by a quarter so that
/// neighbours are continuous, down, back and up. A face of `face` pixels spans 90 degrees; a
/// pixel's distance from its centre is proportional to the angle, not to the tangent. The seam
/// between both lenses runs through the middles of the four outer faces, from top to bottom: there
/// what each lens shows of the other's half, `overlap` columns from either, is inserted.
struct EacLayout {
  /// Width and height of a face without overlap, pixels.
  int face = 0;
  /// Columns that each lens shows beyond the middle of an outer face.
  int overlap = 0;

  /// Size of the sphere with the resolution of the faces.
  cv::Size sphere() const { return {4 * face, 2 * face}; }
};

/// Returns the layout of tracks of that size, or nullopt if it is none. The camera's sizes are
/// 2272x736, 4096x1344 and 5888x1920.
std::optional<EacLayout> EacLayoutOf(cv::Size track);

/// Gives for a direction its samples in the images of the first (0) and the second (1) track.
StitchSampler EacSampler(const EacLayout& layout);

}  // namespace orb360
