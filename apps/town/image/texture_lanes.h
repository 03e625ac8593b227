#pragma once

#include <array>

#include "apps/town/image/lanes.h"
#include "apps/town/image/texture.h"

namespace orb360::town {

/// Texture::Sample for each lane with a texture of its own. Adds the colours to `sum`.
void AddSamples(const std::array<const Texture*, kLanes>& textures, const Lanes& u, const Lanes& v,
                const Lanes& level, Lanes3* sum);

}  // namespace orb360::town
