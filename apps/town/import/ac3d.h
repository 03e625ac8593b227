#pragma once

#include <filesystem>

#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// Reads a scene in AC3D's text format (.ac, and .acc with the additions of the TORCS racing
/// simulator: normals after positions, triangle strips, and several textures with coordinates each,
/// of which the first, the base, is used). Lines are ignored. Throws UserError that names file and
/// line.
SourceScene ReadAc3d(const std::filesystem::path& path);

}  // namespace orb360::town
