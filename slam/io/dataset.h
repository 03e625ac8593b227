#pragma once

#include <filesystem>
#include <optional>

namespace orb360 {

/// A sequence folder: `rgb/000000.jpg`..., `depth/000000.png`..., `groundtruth.txt` (TUM) and
/// `sequence.yaml`. Of the last, only the camera model, the frame rate and the camera's height are
/// read: the rest would tell a SLAM system the answer.
struct Dataset {
  static constexpr const char* kDepthName = "depth";
  static constexpr const char* kGroundTruthName = "groundtruth.txt";

  std::filesystem::path folder;
  /// Frames a second.
  double frame_rate = 0.0;
  /// Metres above the ground.
  std::optional<double> camera_height;

  std::filesystem::path images() const { return folder / "rgb"; }
  std::filesystem::path depth() const { return folder / kDepthName; }
  std::filesystem::path groundtruth() const { return folder / kGroundTruthName; }
};

/// True when `path` is a folder that holds a `sequence.yaml`.
bool IsDataset(const std::filesystem::path& path);

/// Reads `sequence.yaml`: `camera.model` (must be `equirectangular`), `fps` (frames a
/// second) and, optional, `camera_height` (metres). Throws UserError, naming file and line.
Dataset OpenDataset(const std::filesystem::path& folder);

}  // namespace orb360
