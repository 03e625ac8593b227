#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "slam/io/export/export_scene.h"
#include "slam/io/export/view_images.h"
#include "slam/io/positions/georeference.h"

namespace orb360 {

/// Name of the file in the folder of an export.
inline constexpr const char* kMcapName = "run.mcap";

/// Throws UserError where a time of the frames, or with the georeference their UTC, is none that
/// messages of ROS can have.
void CheckRosTimes(const ExportScene& scene, const std::optional<Georeference>& georeference);

/// Writes `folder`/run.mcap (docs/formats/export.md): messages of ROS 2 with the poses of the
/// frames, the points, the images where `sequence` gives them, and positions on Earth where there
/// is a georeference. `input` names the sequence in errors. One image is in memory at a time. The
/// file does not appear where `progress` stops. Contract: the scene has panoramas, and times that
/// CheckRosTimes accepts. Throws UserError.
void ExportMcap(const ExportScene& scene, const std::optional<Georeference>& georeference,
                const std::string& input, Sequence* sequence, const std::filesystem::path& folder,
                const ExportProgress& progress);

}  // namespace orb360
