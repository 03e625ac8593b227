#pragma once

#include <filesystem>
#include <optional>

namespace orb360 {

/// A sequence folder: `rgb/000000.jpg`..., `depth/000000.png`..., `groundtruth.txt` (TUM) and
/// `sequence.yaml` (docs/formats/sequence.md). Only the camera model, the frame rate and the
/// camera's height are read from the last one, because the rest would tell a SLAM system the
/// answer.
struct Dataset {
  static constexpr const char* kDepthName = "depth";
  static constexpr const char* kConfidenceName = "confidence";  // of a run's depth
  static constexpr const char* kSourceName = "source";          // of these ranges
  static constexpr const char* kGroundTruthName = "groundtruth.txt";

  std::filesystem::path folder;
  /// Frames per second.
  double frame_rate = 0.0;
  /// Height of the camera above the ground, metres.
  std::optional<double> camera_height;

  std::filesystem::path images() const { return folder / "rgb"; }
  std::filesystem::path depth() const { return folder / kDepthName; }
  std::filesystem::path groundtruth() const { return folder / kGroundTruthName; }
};

/// Returns true when `path` is a folder that contains a `sequence.yaml`.
bool IsDataset(const std::filesystem::path& path);

/// Reads `sequence.yaml`: `camera.model` (must be `equirectangular`), `fps` (frames per second) and
/// the optional `camera_height` (metres). Throws UserError that names file and line.
Dataset OpenDataset(const std::filesystem::path& folder);

}  // namespace orb360
