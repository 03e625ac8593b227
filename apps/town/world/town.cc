#include "apps/town/world/town.h"

#include <utility>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/boundary.h"
#include "apps/town/world/building.h"
#include "apps/town/world/furnish.h"
#include "apps/town/world/ground.h"
#include "apps/town/world/landmarks.h"
#include "apps/town/world/lots.h"
#include "apps/town/world/road_details.h"

namespace orb360::town {

StreetPlan PlanTown(uint64_t seed, PlanOptions plan) {
  plan.seed = Random(seed).Fork(2).Next();
  return PlanStreets(plan);
}

Town BuildTown(uint64_t seed, PlanOptions plan) {
  const Random random(seed);
  Town town;
  Materials materials = PaintMaterials(random.Fork(1).Next());
  town.plan = PlanTown(seed, plan);
  MeshBuilder builder(materials);
  AddGround(town.plan, builder);
  AddRoadMarkings(town.plan, builder);
  for (const Park& park : town.plan.parks) AddParkPaths(town.plan, park, builder);
  for (const Bridge& bridge : town.plan.bridges) AddBridge(town.plan, bridge, builder);
  AddRoadDetails(town.plan, random.Fork(5), builder);
  Random lots_random = random.Fork(3);
  uint64_t number = 100;
  const std::vector<Lot> lots = LayOutLots(town.plan, lots_random);
  for (const Lot& lot : lots) {
    Random lot_random = random.Fork(number++);
    AddBuilding(lot, lot_random, builder);
  }
  AddBoundaries(lots, random.Fork(6), builder);
  town.scenery.fixed = std::move(builder.mesh());
  FurnishStreets(random.Fork(4), materials, &town);
  town.scenery.fixed.PartitionCutouts(materials);
  for (Mesh& model : town.scenery.models) model.PartitionCutouts(materials);
  town.scenery.palette = std::move(materials);
  return town;
}

}  // namespace orb360::town
