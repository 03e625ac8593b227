#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/orb360/dense_output.h"
#include "apps/orb360/stage_times.h"
#include "slam/scale/scale_measurement.h"
#include <orb360/slam/pipeline/reconstruction.h>
#include <orb360/slam/pipeline/scale_options.h>
#include <orb360/slam/pipeline/view_depth_report.h>

namespace orb360 {

/// The record of a run, collected while its frames are processed.
struct RunRecord {
  int frames = 0;
  /// Wall time from the first frame to the finished map, s.
  double seconds = 0.0;
  /// The part of it after the last frame, s.
  double finishing_seconds = 0.0;
  /// What stereo has measured.
  ViewDepthReport depth;
  /// Wall time of computing the depth, of fusing the dense cloud and of the mesh, s.
  double fusion_seconds = 0.0;
  StageTimes times;
  std::vector<std::string> warnings;
  /// What stopped the run before its end: a failure of the input or the disk. Null where there was
  /// none.
  std::exception_ptr failure;
};

/// The options of a run, and what was determined before the first frame.
struct RunDescription {
  std::string input;
  std::string lens;           ///< --lens as given.
  std::optional<double> fps;  ///< --fps as given, frames per second.
  std::string mask;
  double masked_fraction = 0;  ///< Fraction of the sphere's solid angle.
  std::string weights;
  std::string device;  ///< On which the network ran (nn::Device::name); "none" without a network.
  std::string precision;  ///< In which its convolutions multiplied; "none" without a network.
  int threads = 0;
  nlohmann::json positions;  ///< DescribePositions; null where there were none.
};

/// Returns the content of summary.json.
nlohmann::json Summarize(const Reconstruction& reconstruction, const RunRecord& record,
                         const std::optional<DenseOutput>& dense,
                         const RunDescription& description);

/// What commands on a finished run need of its summary.json.
struct RunSummary {
  std::string input;               ///< INPUT as given.
  std::string lens;                ///< --lens as given.
  std::optional<double> fps;       ///< --fps as given, frames per second.
  bool is_levelled = false;        ///< Whether the world's z axis is the normal of the ground.
  bool has_unknown_scale = false;  ///< Whether lengths have an arbitrary unit.
  /// What tells the scale of the run, other than positions.
  std::optional<ScaleMeasurement> scale;
};

/// Reads a summary.json. What an older version has not written is absent. Throws UserError for a
/// damaged file.
RunSummary ReadSummary(const std::filesystem::path& path);

/// Prints the last lines of a run, which tell how much was tracked and where the results are.
void PrintResult(const nlohmann::json& summary, const std::filesystem::path& folder);

}  // namespace orb360
