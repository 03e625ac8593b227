#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "slam/viewer/run_scene.h"

namespace orb360 {

/// What `orb360 view` and `orb360 report` show of a finished run.
struct ViewedRun {
  RunScene scene;
  std::filesystem::path octree;        ///< Empty where there is none.
  std::filesystem::path views;         ///< Folder of the depth maps of scene.views.
  std::filesystem::path other_octree;  ///< Of a run that it is compared with; empty: none.
};

/// Reads the folder of a run. What it lacks, as one of an older version may, is left out and named
/// in scene.missing. Makes the octree where it is missing, and says so unless `is_quiet`. Throws
/// UserError with one line where the folder holds no finished run, or its summary, reconstruction,
/// scale or cloud is damaged, and Interrupted after an interrupt.
ViewedRun OpenViewedRun(const std::filesystem::path& folder, bool is_quiet);

/// Reads the summary of a run. Throws UserError where the folder holds no finished run, and for a
/// damaged file.
nlohmann::json ReadSummaryJson(const std::filesystem::path& folder);

/// Reads an image of scene.images from the input of the run, at its own size. Throws UserError.
cv::Mat LoadInputImage(const ViewedRun& run, int frame);

}  // namespace orb360
