#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// Triangles of an SPM file that share a texture.
struct SpmPart {
  std::string texture;  ///< name of the file, without its folder; empty for none
  SourceMesh mesh;      ///< in the axes of the file; its material is not set
};

/// Reads a mesh in SuperTuxKart's format SPM, version 1. Its axes are left-handed with y upward;
/// the front of a triangle is clockwise there. Of two textures on a surface the first is used.
/// Meshes with joints are read in their rest pose. Throws UserError that names the file.
std::vector<SpmPart> ReadSpm(const std::filesystem::path& path);

}  // namespace orb360::town
