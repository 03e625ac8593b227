#pragma once

#include <filesystem>
#include <span>

#include "slam/evaluation/cloud_error.h"
#include "slam/evaluation/trajectory_error.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// Compares a dense cloud (SurfacePlyWriter) with the surface that the depth images of a sequence
/// folder see (`depth/000000.png` belongs to the first pose of `truth`, and so on). Pixels that
/// `moving/` marks are ignored. Each point is transformed by the error of the nearest pair of poses
/// (AlignLocally). Throws UserError that names the file if one cannot be read or used.
CloudErrors CompareCloudFile(const std::filesystem::path& cloud,
                             const std::filesystem::path& sequence,
                             std::span<const StampedPose> truth, std::span<const PosePair> pairs,
                             int num_threads);

}  // namespace orb360
