#pragma once

#include <string>

#include <Eigen/Core>

#include "slam/evaluation/local_scale.h"

namespace orb360 {

/// Draws the local scale over the travelled distance as elements of SVG. `origin` is the pixel of
/// the lower left corner and `size` the size in pixels of the frame; labels lie outside of it. Each
/// ratio stands in the middle of its window. The ratio's axis is logarithmic, so that a drift of
/// the same rate has the same slope everywhere, and its line has a gap where windows are missing.
std::string DrawLocalScale(const LocalScale& scale, const Eigen::Vector2d& origin,
                           const Eigen::Vector2d& size);

}  // namespace orb360
