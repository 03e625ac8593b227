#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Trajectory files are TUM: lines `timestamp tx ty tz qx qy qz qw` of world_from_camera in seconds
/// and metres. Their camera frame is the optical one (x right, y down, z forward), and '#' begins a
/// comment. In memory the camera frame is the paper's (-X forward, +Y right, +Z up). Only the
/// functions below convert between the two.
struct StampedPose {
  /// Time, seconds.
  double timestamp = 0.0;
  /// Pose of the camera in the paper's frame.
  Rigid3 world_from_camera;
};

/// Returns the transform from the map's frame to the frame of written files (ROS REP-103: x
/// forward, y left, z up), whose origin and heading are those of the first tracked camera.
/// `up_in_map` is the normal of the ground, of any length, pointing to the sky. If it is given, the
/// frame is levelled: z lies along the normal, and x is the horizontal part of the camera's forward
/// direction, or of its right direction turned by 90 degrees when the camera looks straight up or
/// down.
Rigid3 FileWorldFromMap(const Rigid3& map_from_first_camera,
                        const std::optional<Eigen::Vector3d>& up_in_map = std::nullopt);

/// Returns one line of a trajectory file without the newline: nine decimals of a second, nine
/// significant digits, and a quaternion with qw >= 0.
std::string FormatTumLine(const StampedPose& pose);

/// Writes a whole file. Each pose is first transformed into the file's world. Throws UserError.
void WriteTrajectory(const std::filesystem::path& path, std::span<const StampedPose> poses,
                     const Rigid3& file_world_from_map = {});

/// Reads the poses of a file in its order and its world. Throws UserError with file and line for a
/// line that is not eight numbers with a quaternion of length 1 (within 1 %), and for a file that
/// cannot be opened or has no pose.
std::vector<StampedPose> ReadTrajectory(const std::filesystem::path& path);

}  // namespace orb360
