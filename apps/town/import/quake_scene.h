#pragma once

#include <filesystem>

#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// Reads a map of Quake 3 with its baked light, z up, in the map's units (a player is 56 units
/// high, so a unit is about 1/32 m). Scripts of surfaces and images are searched in the folder of
/// the game, which is the one above that of the map. Doors are left out, as if they stood open.
/// Throws UserError.
SourceScene ReadQuakeScene(const std::filesystem::path& path);

}  // namespace orb360::town
