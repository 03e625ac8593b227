#pragma once

#include <ostream>

#include <nlohmann/json.hpp>

#include "slam/evaluation/cloud_error.h"
#include "slam/evaluation/depth_folder.h"
#include "slam/evaluation/revisit.h"
#include "slam/evaluation/trajectory_error.h"

namespace orb360 {

/// The report of `orb360 evaluate --json`: lengths in metres, angles in degrees.
nlohmann::json ToJson(const TrajectoryErrors& errors);

/// The part under its key "depth". Bins that no pixel falls into have null for errors.
nlohmann::json ToJson(const DepthFolderErrors& depth);

/// The part under its key "cloud": fractions of points near the surface (accuracy) and of the
/// surface near points (completeness), at two distances.
nlohmann::json ToJson(const CloudErrors& errors);

/// The part under its key "loops".
nlohmann::json ToJson(const LoopErrors& errors);

/// A report as a table for people.
void PrintReport(const nlohmann::json& report, std::ostream& out);

}  // namespace orb360
