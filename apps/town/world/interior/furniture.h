#pragma once

#include "apps/town/world/interior/kit.h"

/// Furniture. Each piece stands on its panel's ground with its back at depth 0: `width` to the
/// right, `depth` outward, metres.
namespace orb360::town {

// --- seats and beds ---
/// A chair, 0.45 m wide and deep; one looks out along the panel.
void AddChair(Kit& kit, const Panel& p);
/// A chair on castors, 0.55 m wide and deep.
void AddOfficeChair(Kit& kit, const Panel& p);
/// A sofa or an armchair.
void AddSofa(Kit& kit, const Panel& p, float width, float depth);
/// A bed with its head at depth 0.
void AddBed(Kit& kit, const Panel& p, float width, float depth);
/// A bench without back.
void AddBench(Kit& kit, const Panel& p, float width, float depth);

// --- tables ---
void AddTable(Kit& kit, const Panel& p, float width, float depth, float height);
/// A desk whose user sits at its far side, with screen, keyboard and papers.
void AddDesk(Kit& kit, const Panel& p, float width, float depth);
/// Things of the household on a horizontal surface at height z: cups, books, bottles, boxes.
void AddClutter(Kit& kit, const Panel& p, float x0, float x1, float depth0, float depth1, float z,
                int count);

// --- storage ---
/// A cupboard with doors, or with drawers.
void AddCupboard(Kit& kit, const Panel& p, float width, float depth, float height,
                 bool has_drawers);
/// A set of open shelves with books, boxes and things.
void AddBookcase(Kit& kit, const Panel& p, float width, float depth, float height);
/// A steel rack with goods, open to both sides.
void AddRack(Kit& kit, const Panel& p, float width, float depth, float height);
/// A pile of cardboard boxes.
void AddCartons(Kit& kit, const Panel& p, float width, float depth, float height);
/// Lockers with louvres.
void AddLockers(Kit& kit, const Panel& p, float width, float depth, float height);

// --- kitchen and bath ---
/// A worktop over cupboards with sink and stove, wall cupboards above, and a refrigerator.
void AddKitchen(Kit& kit, const Panel& p, float width, float depth, float ceiling,
                bool has_wall_units);
void AddBath(Kit& kit, const Panel& p, float width, float depth);
void AddBasin(Kit& kit, const Panel& p, float width, float depth);
void AddToilet(Kit& kit, const Panel& p, float width, float depth);
/// A washing machine or another white box with a round door.
void AddWashingMachine(Kit& kit, const Panel& p, float width, float depth);

// --- smaller things ---
void AddPlant(Kit& kit, const Panel& p, float width, float height);
void AddFloorLamp(Kit& kit, const Panel& p, float height, std::vector<Lamp>* lamps, float radiance);
/// A television or a screen on a low board.
void AddTelevision(Kit& kit, const Panel& p, float width, float depth);
void AddBarrel(Kit& kit, const Panel& p, float width);

}  // namespace orb360::town
