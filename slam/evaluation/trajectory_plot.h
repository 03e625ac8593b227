#pragma once

#include <optional>
#include <span>
#include <string>

#include "slam/evaluation/local_scale.h"
#include "slam/evaluation/trajectory_error.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// Draws a trajectory as self-contained SVG. The left side shows the estimate, aligned by the
/// similarity of `errors`, over the ground truth from above (x to the right, y up, metres),
/// coloured by the position error. The right side shows that error over time. Below them is the
/// local scale over the travelled distance, where there is one. `truth` is the whole ground truth;
/// `pairs` and `errors` are the input and result of EvaluateTrajectory.
std::string PlotTrajectory(std::span<const StampedPose> truth, std::span<const PosePair> pairs,
                           const TrajectoryErrors& errors, const std::optional<LocalScale>& scale);

}  // namespace orb360
