#pragma once

#include <ostream>

#include <nlohmann/json.hpp>

#include "slam/evaluation/depth_folder.h"

namespace orb360 {

/// Returns the part of the report of `orb360 evaluate --json` under the key "depth"
/// (docs/formats/evaluation.md). The errors of bins without pixels are null.
nlohmann::json ToJson(const DepthFolderErrors& depth);

/// Prints that part as tables.
void PrintDepth(const nlohmann::json& depth, std::ostream& out);

}  // namespace orb360
