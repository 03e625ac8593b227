#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include "apps/orb360/run_summary.h"
#include "slam/io/sparse_model.h"

namespace orb360 {

/// What the folder of a finished run tells the commands that go on with it.
struct FinishedRun {
  std::filesystem::path folder;
  SparseModel model;
  RunSummary summary;
  cv::Mat mask;  ///< CV_8UC1, 0 where the images are not to be used; empty: no mask.
};

/// Reads the folder. Throws UserError with one line where it holds no finished run, a run of an
/// older version, or a damaged file.
FinishedRun OpenFinishedRun(const std::filesystem::path& folder);

}  // namespace orb360
