#pragma once

#include <filesystem>

#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// Reads the triangles of any file that the Assimp library reads (OBJ, glTF, ...), with each node
/// in its place. Lines and points are ignored. Throws UserError.
SourceScene ReadWithAssimp(const std::filesystem::path& path);

}  // namespace orb360::town
