#pragma once

#include <filesystem>

#include "apps/orb360/viewed_run.h"

namespace orb360 {

/// What `--compare` of `orb360 view` and `orb360 report` says in --help.
inline constexpr const char* kCompareHelp =
    "Also show another path, aligned, and the error along the path: that of another run (its "
    "folder), of the ground truth of a sequence (its folder), or of a TUM trajectory (a file)";

/// Adds the path with which a run is compared (kCompareHelp). Throws UserError with one line where
/// `other` is none of these, is damaged, or cannot be aligned with the run.
void CompareWith(const std::filesystem::path& other, ViewedRun* run);

/// Adds the cloud of the other run, where CompareWith has found one there. Makes its octree where
/// it is missing, and says so. Throws as OpenViewedRun does.
void AddOtherCloud(const std::filesystem::path& other, ViewedRun* run);

}  // namespace orb360
