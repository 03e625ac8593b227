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

/// A map seen from above as self-contained SVG: landmarks (grey), the links of the covisibility
/// graph (green), and the keyframes in their order (blue). Positions: x to the right, y up, in
/// the unit of the map. Landmarks far outside of where the keyframes are do not shrink the picture;
/// they are left out.
std::string PlotMap(std::span<const Eigen::Vector2d> keyframes, std::span<const MapLink> links,
                    std::span<const Eigen::Vector2d> landmarks);

}  // namespace orb360
