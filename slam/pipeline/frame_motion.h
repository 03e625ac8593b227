#pragma once

#include <optional>
#include <span>

#include "slam/features/matching.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

/// Pose of a frame from its matches with the last one, some of them wrong. Rotation and direction
/// of the motion between both come from all matches (five points in RANSAC), its length from those
/// whose feature of the last frame has a landmark: a handful is enough where the landmarks alone
/// would not give a pose. Empty where no motion agrees with half of the matches.
std::optional<Rigid3> PoseFromMotion(const Features& features, const TrackedFrame& last,
                                     const LocalMap& local, std::span<const Match> matches);

}  // namespace orb360
