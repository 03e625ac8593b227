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

/// Returns a position of the file in the scenery: z up, in metres.
Eigen::Vector3f ToWorld(const Eigen::Vector3f& position, const ImportOptions& options);

/// Reads a file of meshes: AC3D, tracks of SuperTuxKart (scene.xml) and maps of Quake 3 (.bsp) with
/// readers of their own, all other formats with Assimp. Throws UserError.
SourceScene ReadMeshFile(const std::filesystem::path& path);

/// Converts the meshes to a scenery, z up, in metres. Textures (PNG, JPEG, SGI, TGA and other
/// formats that OpenCV reads) are searched in `folder`, in the options' folders, and where circuits
/// of TORCS keep shared ones, by the path that the file gives and by the name only. A surface is
/// absent where its texture is transparent. Textures that cannot be read are replaced by grey;
/// they are added to `missing`, each once, with the reason.
Scenery MakeScenery(const SourceScene& source, const std::filesystem::path& folder,
                    const ImportOptions& options, std::vector<std::string>* missing);

}  // namespace orb360::town
