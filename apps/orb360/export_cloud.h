#pragma once

#include <filesystem>
#include <optional>

#include "apps/orb360/finished_run.h"
#include "slam/io/export/las.h"

namespace orb360 {

/// Name of the cloud in the folder of an export.
inline constexpr const char* kLasName = "cloud.las";

/// Measures the dense cloud of a run for `--to las`. Throws UserError, and Interrupted.
LasCloud MeasureCloudOf(const FinishedRun& run, const std::optional<Georeference>& georeference);

/// Writes it to the folder `out` and says where its points lie, unless `is_quiet`. Throws
/// UserError, and Interrupted.
void WriteCloud(const LasCloud& cloud, const std::optional<Georeference>& georeference,
                const std::filesystem::path& out, bool is_quiet);

}  // namespace orb360
