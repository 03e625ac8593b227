#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/rigid3.h"
#include "slam/io/output_file.h"

namespace orb360 {

/// Trajectory files are TUM: lines `timestamp tx ty tz qx qy qz qw` of world_from_camera in
/// seconds and metres, the camera frame optical (x right, y down, z forward), '#' for comments.
/// In memory the camera frame is the paper's (-X forward, +Y right, +Z up). Files and memory meet
/// in the functions below, nowhere else.
struct StampedPose {
  /// Seconds.
  double timestamp = 0.0;
  /// The camera in the paper's frame.
  Rigid3 world_from_camera;
};

/// The frame of written files (ROS REP-103: x forward, y left, z up) from the map's frame, its
/// origin and heading those of the first tracked camera. With `up_in_map`, the normal of the
/// ground, of any length, pointing to the sky, it is levelled: z along it, x the camera's forward
/// direction brought to the horizontal (its right, turned by 90 degrees, when it looks straight up
/// or down).
Rigid3 FileWorldFromMap(const Rigid3& map_from_first_camera,
                        const std::optional<Eigen::Vector3d>& up_in_map = std::nullopt);

/// One line of a trajectory file, without the newline: nanoseconds, nine significant digits, the
/// quaternion with qw >= 0.
std::string FormatTumLine(const StampedPose& pose);

/// Writes a whole file, each pose moved into the file's world first. Throws UserError.
void WriteTrajectory(const std::filesystem::path& path, std::span<const StampedPose> poses,
                     const Rigid3& file_world_from_map = {});

/// The poses of a file in its order and its world. Throws UserError with file and line for a line
/// that is not eight numbers with a quaternion of length 1 (within 1 %), and for a file that
/// cannot be opened or has no pose.
std::vector<StampedPose> ReadTrajectory(const std::filesystem::path& path);

/// A trajectory file that grows with the run: a killed run loses at most the pose it was at.
class TrajectoryJournal {
 public:
  /// Throws UserError if the file cannot be written, as does Append.
  explicit TrajectoryJournal(const std::filesystem::path& path) : file_(path) {}

  void Append(const StampedPose& pose) { file_.Write(FormatTumLine(pose) + "\n"); }

 private:
  OutputFile file_;
};

}  // namespace orb360
