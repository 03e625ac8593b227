#pragma once

#include <filesystem>

#include "slam/io/output_file.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// A trajectory file that grows during the run. A killed run loses at most the pose that was being
/// written.
class TrajectoryJournal {
 public:
  /// Throws UserError if the file cannot be written. Append does so too.
  explicit TrajectoryJournal(const std::filesystem::path& path) : file_(path) {}

  void Append(const StampedPose& pose) { file_.Write(FormatTumLine(pose) + "\n"); }

 private:
  OutputFile file_;
};

}  // namespace orb360
