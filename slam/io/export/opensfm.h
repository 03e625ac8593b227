#pragma once

#include <filesystem>
#include <optional>

#include "slam/io/export/export_scene.h"
#include "slam/io/positions/georeference.h"

namespace orb360 {

/// Writes OpenSfM's `reconstruction.json` with one spherical camera. With a georeference, its world
/// is the topocentric frame of that (Projection::Local), whose origin is stated in it and in
/// `reference_lla.json`. Contract: the panorama is the only view. Throws UserError where the disk
/// fails.
void ExportOpensfm(const ExportScene& scene, const std::optional<Georeference>& georeference,
                   const std::filesystem::path& folder);

}  // namespace orb360
