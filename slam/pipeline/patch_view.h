#pragma once

#include <memory>
#include <optional>

#include "slam/features/patch_alignment.h"
#include "slam/map/map.h"

namespace orb360 {

/// Noise of a bearing that a patch was aligned at, as a fraction of a corner's on the same level;
/// less makes trajectories no better (docs/results/features.md).
inline constexpr double kAlignedNoise = 0.35;

/// How an image shows a landmark's patch: what AlignPatch starts from.
struct PatchView {
  const PyramidLevel* level;  // of the image
  PatchGrid grid;             // its centre is where the landmark's position is projected
  Eigen::Vector2d stretch;    // how the steps change with the surface's slope
};

/// The patch around a feature of a keyframe, whose image must be kept. Null too near a pole.
std::shared_ptr<const LandmarkPatch> CutPatch(const Keyframe& keyframe, int feature);

/// The patch of a landmark, which must have one, in a keyframe whose image is kept. Empty too
/// near a pole, and where it is seen from so far away that nothing of it is left.
std::optional<PatchView> ViewPatch(const Map& map, const Landmark& landmark,
                                   const Keyframe& keyframe);

}  // namespace orb360
