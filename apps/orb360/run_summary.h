#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/orb360/dense_output.h"
#include "apps/orb360/stage_times.h"
#include "slam/pipeline/options.h"
#include "slam/pipeline/reconstruction.h"

namespace orb360 {

/// What the loop over the frames leaves behind.
struct RunRecord {
  int frames = 0;
  double seconds = 0.0;            // from the first frame to the finished map
  double finishing_seconds = 0.0;  // of those, after the last frame
  double fusion_seconds = 0.0;     // of the dense cloud
  StageTimes times;
  std::vector<std::string> warnings;
  std::exception_ptr failure;  // of the input or the disk, in the middle
};

/// What a run was asked for, and what it found before the first frame.
struct RunDescription {
  std::string input;
  std::string mask;
  double masked_fraction = 0;  // of the sphere
  std::string weights;
  ScaleOptions scale;
  int threads = 0;
};

/// The content of summary.json.
nlohmann::json Summarize(const Reconstruction& reconstruction, const RunRecord& record,
                         const std::optional<DenseOutput>& dense,
                         const RunDescription& description);

/// The last lines of a run: what was tracked, and where the results are.
void PrintResult(const nlohmann::json& summary, const std::filesystem::path& folder);

}  // namespace orb360
