#pragma once

#include <filesystem>
#include <span>

#include "slam/io/sparse_model.h"

namespace orb360 {

// Writers of trajectories. Each writes poses of the optical camera frame (x right, y down, z
// forward) in the order of the frames, and throws UserError where the disk fails.
// docs/formats/export.md describes the formats and names their sources.

/// Writes `trajectory.txt`: lines `timestamp tx ty tz qx qy qz qw`, seconds and metres,
/// world_from_camera (TUM RGB-D).
void ExportTum(std::span<const PosedFrame> frames, const std::filesystem::path& folder);

/// Writes `poses.txt`, the first three rows of first_camera_from_camera, row by row, one line for
/// each frame, and `times.txt`, seconds since the first frame (KITTI odometry).
void ExportKitti(std::span<const PosedFrame> frames, const std::filesystem::path& folder);

/// Writes `trajectory.csv`: lines `timestamp,px,py,pz,qw,qx,qy,qz`, nanoseconds and metres,
/// world_from_camera (the first columns of the ground truth of EuRoC MAV).
void ExportEuroc(std::span<const PosedFrame> frames, const std::filesystem::path& folder);

}  // namespace orb360
