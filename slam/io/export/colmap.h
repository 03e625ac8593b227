#pragma once

#include <filesystem>

#include "slam/io/export/export_scene.h"

namespace orb360 {

enum class ColmapFiles { kBinary, kText };

/// Writes the files of a COLMAP model (cameras, rigs, frames, images, points3D) into
/// `folder`/sparse/0. All views are sensors of one rig, whose frame is that of the first view.
/// COLMAP before 3.12 does not read rigs and frames and finds everything in the other files; a
/// panorama (camera model EQUIRECTANGULAR) needs COLMAP 4.1. Throws UserError where the disk fails.
void ExportColmap(const ExportScene& scene, ColmapFiles files, const std::filesystem::path& folder);

}  // namespace orb360
