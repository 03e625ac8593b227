#pragma once

#include "apps/town/world/interior/placement.h"

/// Groups of furniture that several kinds of room have. Each is left out where there is no room.
/// Heights and widths are drawn between `low` and `high`, metres.
namespace orb360::town {

/// A chair before the front edge of something `depth` deep, `x` to the right on its panel.
void ChairBefore(Placement& placement, const Panel& p, float x, float depth, bool office);
void Plants(Placement& placement, int max);
/// Cupboards of a height.
void Cupboards(Placement& placement, int count, double low, double high);
void Bookcases(Placement& placement, int count);
/// A table of a width, with chairs on both sides.
void TableWithChairs(Placement& placement, double low, double high);
void Desks(Placement& placement, int count);
void Cartons(Placement& placement, int count);
/// Steel racks along walls.
void Racks(Placement& placement, int count, double high);
/// A rug in the middle of the room.
void Rug(Placement& placement);

}  // namespace orb360::town
