#pragma once

#include <optional>
#include <span>

#include "slam/features/matching.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

/// Estimates the pose of a frame from its matches with the last frame, some of which are wrong. The
/// rotation and the direction of the motion between the two frames follow from all matches (five
/// points in RANSAC). The length of the motion follows from the matches whose feature of the last
/// frame has a landmark; a handful of them is enough, where the landmarks alone would not determine
/// a pose. Empty where no motion agrees with half of the matches.
std::optional<Rigid3> PoseFromMotion(const Features& features, const TrackedFrame& last,
                                     const LocalMap& local, std::span<const Match> matches);

}  // namespace orb360
