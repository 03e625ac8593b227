#pragma once

#include <filesystem>

#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// Reads the triangles of any file that the Assimp library reads (OBJ, glTF, ...), each node where
/// it stands. Lines and points are left out. Throws UserError.
SourceScene ReadWithAssimp(const std::filesystem::path& path);

}  // namespace orb360::town
