#pragma once

#include <span>
#include <string>

#include "slam/evaluation/trajectory_error.h"
#include "slam/io/trajectory.h"

namespace orb360 {

/// A picture as self-contained SVG: left, the estimate, aligned by the similarity of `errors`, over
/// the ground truth, seen from above (x to the right, y up, metres), its colour the position
/// error; right, that error over time. `truth` is the whole ground truth, `pairs` and `errors`
/// what EvaluateTrajectory was given and gave.
std::string PlotTrajectory(std::span<const StampedPose> truth, std::span<const PosePair> pairs,
                           const TrajectoryErrors& errors);

}  // namespace orb360
