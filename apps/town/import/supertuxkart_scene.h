#pragma once

#include <filesystem>

#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// Reads what stands still in a track or an arena of SuperTuxKart from its scene.xml: the track's
/// model, objects, water, and nodes of the game's library, each in its place, in right-handed axes
/// with y upward (the game's z is turned round) and metres. Of the levels of detail the finest is
/// used. Left out are walls that are for collisions only, lights, particles, glows, objects that
/// move, and those that the game shows in special modes only. Textures are found in the folder of
/// the mesh, that of the track, and the game's data/textures. Throws UserError for damaged files;
/// decorations that do not exist are listed in SourceScene::missing.
SourceScene ReadSuperTuxKartScene(const std::filesystem::path& scene_file);

}  // namespace orb360::town
