#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "apps/orb360/viewed_run.h"

namespace orb360 {

/// Name of the report in the folder of a run.
inline constexpr const char* kReportName = "report.html";

struct ReportOptions {
  double max_mb = 30;  ///< Largest size, 10^6 bytes; the cloud is thinned.
  int views = 12;      ///< Images of keyframes, where the run kept them.
  /// Called now and then. What it throws ends the work, which leaves no file.
  std::function<void()> check = [] {};
};

/// Writes a run as one file that a browser shows without a server. Returns its size in bytes.
/// Throws UserError where `max_mb` has no room for path, images and some points, for a damaged
/// octree or view, and if the disk fails.
std::uintmax_t WriteReport(ViewedRun run, const ReportOptions& options,
                           const std::filesystem::path& out);

}  // namespace orb360
