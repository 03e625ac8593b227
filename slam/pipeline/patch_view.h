#pragma once

#include <memory>
#include <optional>

#include "slam/features/patch_alignment.h"
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Angular noise of an aligned bearing as a fraction of that of a corner on the same level. Smaller
/// values do not improve trajectories (docs/results/features.md).
inline constexpr double kAlignedNoise = 0.35;

/// The projection of a landmark's patch into an image, from which AlignPatch starts.
struct PatchView {
  const PyramidLevel* level;  ///< A level of the keyframe's image pyramid.
  PatchGrid grid;             ///< Its centre is the projection of the landmark's position.
  Eigen::Vector2d stretch;    ///< How the steps of the grid change with the surface's slope.
};

/// Returns the patch around a feature of a keyframe, whose image must be kept. Null where the
/// feature is too near a pole.
std::shared_ptr<const LandmarkPatch> CutPatch(const Keyframe& keyframe, int feature);

/// Projects the patch of a landmark, which must have one, into a keyframe whose image is kept.
/// Empty where the patch is too near a pole, or so far away that it covers less than a few pixels.
std::optional<PatchView> ViewPatch(const Map& map, const Landmark& landmark,
                                   const Keyframe& keyframe);

}  // namespace orb360
