#pragma once

#include <span>
#include <string>

#include <Eigen/Core>

namespace orb360 {

/// A link between two keyframes.
struct MapLink {
  size_t first;  ///< Index of a keyframe.
  size_t second;
  double weight;  ///< In (0, 1]; 1 is drawn darkest.
};

/// Draws a map from above as self-contained SVG: landmarks (gray), the links of the covisibility
/// graph (green), and the keyframes in their order (blue). Positions have x to the right and y up,
/// in the unit of the map. Landmarks far from all keyframes are left out, so that they do not
/// shrink the drawing.
std::string PlotMap(std::span<const Eigen::Vector2d> keyframes, std::span<const MapLink> links,
                    std::span<const Eigen::Vector2d> landmarks);

}  // namespace orb360
