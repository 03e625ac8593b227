#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/geometry/rigid3.h"

namespace orb360::town {

/// What sequence.yaml says about a sequence.
struct SequenceInfo {
  int width = 0;
  int height = 0;
  double fps = 20;
  int frames = 0;
  double camera_height = 0;  ///< metres above the road
  std::string town;
  uint64_t seed = 0;
  std::string light;
  double traffic = 0;
  double mean_speed = 0;  ///< metres per second
  double maximum_speed = 0;
};

/// Writes the folder of a sequence: rgb/000000.jpg, depth/000000.png, groundtruth.txt and
/// sequence.yaml. Files appear under their names only when complete. Throws UserError when
/// something cannot be written.
class SequenceWriter {
 public:
  /// Creates the folders, and writes ground truth and description.
  SequenceWriter(const std::filesystem::path& folder, const SequenceInfo& info,
                 const std::vector<Rigid3>& world_from_camera);

  void WriteColour(int frame, const cv::Mat3b& image) const;
  /// `range` in metres; stored as 16-bit PNG, metres * 256, 0 beyond 255.99 m.
  void WriteRange(int frame, const cv::Mat1f& range) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace orb360::town
