#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/town/import/source_scene.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

enum class UpAxis { kY, kZ };

struct ImportOptions {
  UpAxis up = UpAxis::kY;  ///< of the file; y becomes z, and z becomes -y
  double scale = 1;        ///< metres that a unit of the file is
  std::vector<std::filesystem::path> texture_folders = {};  ///< to look in besides the file's own
};

/// Reads a file of meshes: AC3D with an own reader, all else with Assimp. Throws UserError.
SourceScene ReadMeshFile(const std::filesystem::path& path);

/// The meshes as a scenery, z up, in metres. Textures (PNG, JPEG, SGI and what else OpenCV reads)
/// are looked for in `folder`, in the options' folders, and where circuits of TORCS keep what they
/// share, by the path that the file gives and by the name alone; where one is transparent the
/// surface is absent. Grey stands for those that cannot be read, which `missing` names, each once,
/// with the reason.
Scenery MakeScenery(const SourceScene& source, const std::filesystem::path& folder,
                    const ImportOptions& options, std::vector<std::string>* missing);

}  // namespace orb360::town
