#pragma once

#include <filesystem>

#include "slam/io/depth_map_store.h"
#include "slam/io/export/export_scene.h"

namespace orb360 {

/// Writes `transforms.json` and `sparse_pc.ply` of nerfstudio. Poses are world_from_camera with
/// OpenGL's camera axes (x right, y up, z back); the world has z up. Throws UserError where the
/// disk fails.
void ExportNerfstudio(const ExportScene& scene, const std::filesystem::path& folder);

/// Writes a depth map for each image of a frame in scene.frames_with_depth below `folder`/depth
/// (DepthName): 16-bit PNG of millimetres, 0 where nothing is known or more than 65.535 m. That of
/// a panorama has the distance along the ray, that of a pinhole view the z coordinate. All other
/// frames share one that knows nothing. Throws UserError for a damaged depth map and where the disk
/// fails.
void WriteViewDepth(const ExportScene& scene, const DepthMapStore& store,
                    const std::filesystem::path& folder);

}  // namespace orb360
