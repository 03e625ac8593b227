#include "apps/town/world/interior/interior.h"

#include <cmath>
#include <utility>

#include "apps/town/world/interior/furnish_room.h"
#include "apps/town/world/interior/kit.h"
#include "apps/town/world/interior/outside.h"
#include "apps/town/world/interior/room_lamps.h"
#include "apps/town/world/interior/room_shell.h"
#include "apps/town/world/tessellate.h"

namespace orb360::town {
namespace {

/// Parts of a seed, so that the draws of one part do not affect the others.
enum SeedPart : uint64_t {
  kKind = 1,
  kMaterials,
  kPlan,
  kFinish,
  kLight,
  kOutside,
  kRooms = 100,
  kDoors = 1000
};

/// Returns the longest edge, metres, for which the vertices of a building's walls stay few.
float EdgeFor(const FloorPlan& plan) {
  float floor = 0;  // square metres
  for (const Room& room : plan.rooms) floor += room.area.width() * room.area.depth();
  return floor < 150 ? 0.35F : floor < 500 ? 0.5F : 0.8F;
}

bool HasWindow(const Room& room) {
  for (const auto& holes : room.holes) {
    for (const WallHole& hole : holes) {
      if (hole.is_window) return true;
    }
  }
  return false;
}

}  // namespace

BuildingKind KindOfInterior(uint64_t seed) {
  return static_cast<BuildingKind>(Random(seed).Fork(kKind).Int(kBuildingKinds));
}

Interior BuildInterior(uint64_t seed) { return BuildInterior(seed, KindOfInterior(seed)); }

Interior BuildInterior(uint64_t seed, BuildingKind kind) {
  return BuildInterior(seed, kind, PaintInteriorMaterials(Random(seed).Fork(kMaterials)));
}

Interior BuildInterior(uint64_t seed, BuildingKind kind, InteriorMaterials materials) {
  const Random random = Random(seed).Fork(77);
  Interior interior;
  interior.plan = PlanFloor(kind, random.Fork(kPlan));
  const FloorPlan& plan = interior.plan;
  MeshBuilder builder(materials);
  Scenery& scenery = interior.scenery;
  // Radiance of a white floor under the lamps; the sky has about 1.
  Random light = random.Fork(kLight);
  const auto brightness = static_cast<float>(0.03 * std::exp(light.Uniform(0, 1.2)));
  interior.are_lamps_on = light.Chance(0.7);
  std::vector<Finishes> finishes;
  std::vector<std::vector<Area>> doors(plan.rooms.size());
  for (size_t i = 0; i < plan.rooms.size(); ++i) {
    Random draw = random.Fork(kRooms + i);
    finishes.push_back(
        DrawFinishes(kind, plan.rooms[i].use, materials, random.Fork(kFinish), draw));
    AddRoomShell(plan, plan.rooms[i], finishes[i], draw, builder, &scenery.lamps);
  }
  for (size_t i = 0; i < plan.doorways.size(); ++i) {
    Random draw = random.Fork(kDoors + i);
    for (const Area& leaf :
         AddDoorway(plan.doorways[i], finishes[plan.doorways[i].first], draw, builder))
      interior.taken.push_back(leaf);
  }
  for (size_t i = 0; i < plan.rooms.size(); ++i) {
    Random draw = random.Fork(kRooms + i).Fork(1);
    const Room& room = plan.rooms[i];
    Kit kit = MakeKit(builder, materials, draw);
    // Large rooms are too dark by daylight alone.
    const bool is_large = room.area.width() * room.area.depth() > 50;
    const bool is_dark =
        HasWindow(room) && !is_large && (!interior.are_lamps_on || draw.Chance(0.15));
    const float lit = is_dark ? 0 : brightness * static_cast<float>(draw.Uniform(0.7, 1.4));
    FurnishRoom(kit, plan, room, brightness, &interior.taken, &scenery.lamps);
    AddRoomLamps(kit, room, kind, lit, &interior.taken, &scenery.lamps);
  }
  scenery.fixed = std::move(builder.mesh());
  Tessellate(EdgeFor(plan), &scenery.fixed);
  AddOutside(plan, materials, random.Fork(kOutside), &scenery);
  scenery.fixed.PartitionCutouts(materials);
  for (Mesh& model : scenery.models) model.PartitionCutouts(materials);
  scenery.palette = std::move(materials);
  return interior;
}

}  // namespace orb360::town
