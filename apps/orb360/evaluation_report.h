#pragma once

#include <optional>
#include <ostream>

#include <nlohmann/json.hpp>

#include "slam/evaluation/cloud_error.h"
#include "slam/evaluation/local_scale.h"
#include "slam/evaluation/revisit.h"
#include "slam/evaluation/scale_calibration.h"
#include "slam/evaluation/trajectory_error.h"

namespace orb360 {

/// Returns the report of `orb360 evaluate --json`, with lengths in metres and angles in degrees.
nlohmann::json ToJson(const TrajectoryErrors& errors);

/// Returns the part under the key "cloud": the fractions of the points that are near the surface
/// (accuracy) and of the surface that is near points (completeness), for two distances.
nlohmann::json ToJson(const CloudErrors& errors);

/// Returns the part under the key "local_scale". Values that the path is too short for are null,
/// and so is the whole where there is no window.
nlohmann::json ToJson(const std::optional<LocalScale>& scale);

/// Returns the part under the key "local" of "stated_scale".
nlohmann::json ToJson(const ScaleCalibration& calibration);

/// Returns the part under the key "loops".
nlohmann::json ToJson(const LoopErrors& errors);

/// Prints a report as tables.
void PrintReport(const nlohmann::json& report, std::ostream& out);

}  // namespace orb360
