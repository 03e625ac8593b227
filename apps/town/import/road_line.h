#pragma once

#include <vector>

#include <Eigen/Core>

#include "apps/town/render/ray_scene.h"

namespace orb360::town {

/// The ends of a line across a road, z up, in metres.
struct RoadWidth {
  Eigen::Vector3d left;
  Eigen::Vector3d right;
};

/// Returns places for a camera that follows the middle of a road once round, a metre or less
/// apart; the first is not repeated. The sections may lie a little above or below the surface:
/// each place is `height` above what a ray downward meets there, or, over a gap, above a line that
/// joins its sides; what is shorter than a few metres along the road is no part of it. Where
/// something stands nearer to the middle than a camera may pass, the line swerves into the free
/// part of the road. Throws UserError for a road without length or of an impossible size.
std::vector<Eigen::Vector3d> FollowRoad(const RayScene& scene,
                                        const std::vector<RoadWidth>& sections, double height);

}  // namespace orb360::town
