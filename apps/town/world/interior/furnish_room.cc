#include "apps/town/world/interior/furnish_room.h"

#include <algorithm>
#include <numbers>

#include "apps/town/world/interior/furniture.h"
#include "apps/town/world/interior/furniture_groups.h"
#include "apps/town/world/interior/parked_cars.h"
#include "apps/town/world/interior/placement.h"
#include "apps/town/world/interior/wall_fittings.h"

namespace orb360::town {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

void FurnishLiving(Placement& placement, float brightness, std::vector<Lamp>* lamps) {
  Kit& kit = placement.kit();
  const float width = placement.Draw(1.5, 2.5);
  if (const auto sofa = placement.AtWall(
          width, 0.95F, 0.9F, [&](const Panel& p) { AddSofa(kit, p, width, 0.9F); }, 0.05F)) {
    const float table = placement.Draw(0.7, 1.2);
    const Panel p = Turned(*sofa, 0.5F * (width - table), 1.3F, 0);
    if (placement.IsFree(Placement::AreaOf(p, table, 0.6F))) {
      AddTable(kit, p, table, 0.6F, placement.Draw(0.35, 0.48));
      placement.Take(Placement::AreaOf(p, table, 0.6F));
    }
  }
  if (placement.Chance(0.7))
    placement.AtWall(
        1.6F, 0.45F, 0.7F, [&](const Panel& p) { AddTelevision(kit, p, 1.6F, 0.42F); }, 0.03F);
  for (int i = kit.random.Int(3); i > 0; --i)
    placement.Free(
        0.85F, 0.85F, 0.15F, [&](const Panel& p) { AddSofa(kit, p, 0.85F, 0.85F); }, 0);
  Bookcases(placement, kit.random.Int(3));
  Cupboards(placement, 1 + kit.random.Int(2), 0.7, 1.9);
  if (placement.Chance(0.6)) TableWithChairs(placement, 1.2, 2.2);
  if (placement.Chance(0.6))
    placement.AtWall(
        0.42F, 0.42F, 1.7F,
        [&](const Panel& p) {
          const float radiance = placement.Chance(0.6) ? 25 * brightness : 0;
          AddFloorLamp(kit, p, placement.Draw(1.4, 1.8), lamps, radiance);
        },
        0.05F);
  Plants(placement, 3);
  if (placement.Chance(0.5)) Rug(placement);
}

void FurnishBedroom(Placement& placement) {
  Kit& kit = placement.kit();
  const float width = placement.Chance(0.5) ? placement.Draw(1.4, 1.8) : 0.95F;
  if (const auto bed = placement.AtWall(width, 2.05F, 1,
                                        [&](const Panel& p) { AddBed(kit, p, width, 2.02F); })) {
    for (const float x : {-0.5F, width + 0.06F}) {
      const Panel p = Turned(*bed, x, 0, 0);
      if (!placement.IsFree(Placement::AreaOf(p, 0.42F, 0.4F))) continue;
      AddCupboard(kit, p, 0.42F, 0.37F, placement.Draw(0.4, 0.6), true);
      placement.Take(Placement::AreaOf(p, 0.42F, 0.4F));
    }
  }
  Cupboards(placement, 1 + kit.random.Int(2), 1.8, 2.3);
  Cupboards(placement, kit.random.Int(2), 0.7, 1.1);
  if (placement.Chance(0.4)) Desks(placement, 1);
  if (placement.Chance(0.3)) Bookcases(placement, 1);
  if (placement.Chance(0.4))
    placement.AtWall(
        0.5F, 0.5F, 0.8F, [&](const Panel& p) { AddChair(kit, p); }, 0.05F);
  if (placement.Chance(0.4)) Rug(placement);
  Plants(placement, 1);
  Cartons(placement, kit.random.Int(2));
}

void FurnishBathroom(Placement& placement) {
  Kit& kit = placement.kit();
  const float length = placement.Draw(1.5, 1.75);
  if (placement.Chance(0.6))
    placement.AtWall(
        length, 0.75F, 0.6F, [&](const Panel& p) { AddBath(kit, p, length, 0.75F); }, 0);
  const float basin = placement.Draw(0.5, 0.9);
  placement.AtWall(
      basin, 0.48F, 1.9F, [&](const Panel& p) { AddBasin(kit, p, basin, 0.46F); }, 0);
  placement.AtWall(
      0.4F, 0.68F, 0.85F, [&](const Panel& p) { AddToilet(kit, p, 0.4F, 0.66F); }, 0);
  if (placement.Chance(0.5))
    placement.AtWall(0.6F, 0.62F, 0.9F,
                     [&](const Panel& p) { AddWashingMachine(kit, p, 0.6F, 0.6F); });
  Cupboards(placement, kit.random.Int(2), 0.6, 1.8);
}

void FurnishKitchen(Placement& placement) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  for (int i = 1 + kit.random.Int(2); i > 0; --i) {
    const Area& a = room.area;
    const float width = std::min(placement.Draw(1.6, 4), std::max(a.width(), a.depth()) - 0.3F);
    const bool has_wall_units = placement.Chance(0.7);
    placement.AtWall(
        width, 0.66F, has_wall_units ? room.height : 1.3F,
        [&](const Panel& p) { AddKitchen(kit, p, width, 0.6F, room.height, has_wall_units); }, 0);
  }
  if (placement.Chance(0.7)) TableWithChairs(placement, 0.8, 1.6);
  Cupboards(placement, kit.random.Int(2), 0.9, 2.1);
  if (placement.Chance(0.3))
    placement.AtWall(0.6F, 0.62F, 0.9F,
                     [&](const Panel& p) { AddWashingMachine(kit, p, 0.6F, 0.6F); });
  Plants(placement, 1);
}

void FurnishClassroom(Placement& placement) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  const Area& a = room.area;
  const float pitch_x = placement.Draw(1.7, 2.1);
  const float pitch_y = placement.Draw(1.5, 1.9);
  const bool turned = placement.Chance(0.5);
  for (float x = a.x0 + 1; x < a.x1 - 1; x += pitch_x) {
    for (float y = a.y0 + 1.1F; y < a.y1 - 1; y += pitch_y) {
      if (placement.Chance(0.08)) continue;
      const Panel middle =
          Turned({{x, y, 0}, Vector3f::UnitX(), Vector3f::UnitZ(), -Vector3f::UnitY()}, 0, 0,
                 (turned ? 0.5F * kPi : 0) + placement.Draw(-0.06, 0.06));
      const Panel p = Turned(middle, -0.6F, -0.27F, 0);
      const Area area = Placement::AreaOf(p, 1.2F, 0.55F);
      if (!placement.IsFree(area.Grown(0.15F))) continue;
      AddTable(kit, p, 1.2F, 0.55F, 0.72F);
      placement.Take(area);
      for (const float at : {0.05F, 0.65F}) {
        if (placement.Chance(0.85)) ChairBefore(placement, p, at, 0.4F, false);
      }
    }
  }
  Cupboards(placement, 1 + kit.random.Int(2), 0.8, 2);
  Bookcases(placement, kit.random.Int(2));
}

void FurnishWard(Placement& placement) {
  Kit& kit = placement.kit();
  for (int i = 1 + kit.random.Int(4); i > 0; --i)
    placement.AtWall(0.95F, 2.05F, 1, [&](const Panel& p) { AddBed(kit, p, 0.95F, 2.02F); });
  Cupboards(placement, 1 + kit.random.Int(3), 0.7, 2);
  for (int i = kit.random.Int(4); i > 0; --i)
    placement.AtWall(
        0.5F, 0.5F, 0.9F, [&](const Panel& p) { AddChair(kit, p); }, 0.05F);
  const float basin = placement.Draw(0.5, 0.7);
  if (placement.Chance(0.6))
    placement.AtWall(
        basin, 0.48F, 1.9F, [&](const Panel& p) { AddBasin(kit, p, basin, 0.46F); }, 0);
}

void FurnishWarehouse(Placement& placement) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  const Area& a = room.area;
  const float height = std::min(placement.Draw(2.5, 7), room.height - 0.4F);
  const float depth = placement.Draw(0.8, 1.2);
  const float aisle = placement.Draw(1.8, 3.2);
  const bool along_x = placement.Chance(0.5);
  const float length = along_x ? a.width() : a.depth();
  const float across = along_x ? a.depth() : a.width();
  const double fullness = placement.Draw(0.15, 1);
  for (float y = aisle; y + depth < across - aisle; y += depth + aisle) {
    for (float x = 1.6F; x < length - 3; x += 5.9F) {
      if (!placement.Chance(fullness)) continue;
      const float width = std::min(5.6F, length - x - 1.6F);
      if (width < 2) continue;
      const Panel p = along_x ? Panel{{a.x0 + x, a.y0 + y + depth, 0},
                                      Vector3f::UnitX(),
                                      Vector3f::UnitZ(),
                                      -Vector3f::UnitY()}
                              : Panel{{a.x0 + y, a.y0 + x, 0},
                                      Vector3f::UnitY(),
                                      Vector3f::UnitZ(),
                                      Vector3f::UnitX()};
      const Area area = Placement::AreaOf(p, width, depth);
      if (!placement.IsFree(area.Grown(0.1F))) continue;
      AddRack(kit, p, width, depth, height);
      placement.Take(area);
    }
  }
  Racks(placement, 2 + kit.random.Int(5), 3);
  Cartons(placement, 3 + kit.random.Int(12));
  for (int i = kit.random.Int(10); i > 0; --i) {
    const float width = placement.Draw(0.8, 1.3);
    placement.Free(
        width, 0.9F, 0.5F,
        [&](const Panel& p) { AddCartons(kit, p, width, 0.9F, placement.Draw(0.3, 1.8)); }, 0);
  }
  for (int i = kit.random.Int(8); i > 0; --i)
    placement.AtWall(
        0.6F, 0.6F, 0.9F, [&](const Panel& p) { AddBarrel(kit, p, 0.6F); }, 0.1F);
  if (placement.Chance(0.4)) Desks(placement, 2);
}

}  // namespace

void FurnishRoom(Kit& kit, const FloorPlan& plan, const Room& room, float brightness,
                 std::vector<Area>* taken, std::vector<Lamp>* lamps) {
  Placement placement(kit, plan, room, taken);
  const BuildingKind kind = plan.kind;

  const float area = room.area.width() * room.area.depth();
  const bool is_bare = placement.Chance(0.1) && room.use != RoomUse::kGarage;
  if (!is_bare) {
    switch (room.use) {
      case RoomUse::kPassage:
        if (std::min(room.area.width(), room.area.depth()) < 1.5F) break;
        if (kind == BuildingKind::kSchool && placement.Chance(0.7)) {
          for (int i = 0; i < 4; ++i) {
            const float width = placement.Draw(1.5, 4);
            placement.AtWall(width, 0.45F, 1.8F,
                             [&](const Panel& p) { AddLockers(kit, p, width, 0.42F, 1.8F); });
          }
        }
        for (int i = kit.random.Int(4); i > 0; --i)
          placement.AtWall(
              1.2F, 0.36F, 0.5F, [&](const Panel& p) { AddBench(kit, p, 1.2F, 0.35F); }, 0.03F);
        Cupboards(placement, kit.random.Int(2), 0.7, 1.2);
        Plants(placement, 3);
        Cartons(placement, kit.random.Int(2));
        break;
      case RoomUse::kLiving:
        FurnishLiving(placement, brightness, lamps);
        break;
      case RoomUse::kKitchen:
        FurnishKitchen(placement);
        break;
      case RoomUse::kBedroom:
        FurnishBedroom(placement);
        break;
      case RoomUse::kBathroom:
        FurnishBathroom(placement);
        break;
      case RoomUse::kOffice:
        Desks(placement, 1 + static_cast<int>(area / 9));
        Bookcases(placement, kit.random.Int(3));
        Cupboards(placement, kit.random.Int(3), 0.7, 2);
        if (area > 40 && placement.Chance(0.5)) TableWithChairs(placement, 1.4, 2.4);
        Plants(placement, 3);
        break;
      case RoomUse::kMeeting:
        TableWithChairs(
            placement, 1.8,
            std::max(2.0F, std::min(4.5F, std::max(room.area.width(), room.area.depth()) - 2)));
        Cupboards(placement, kit.random.Int(2), 0.7, 1.2);
        Plants(placement, 2);
        break;
      case RoomUse::kClassroom:
        FurnishClassroom(placement);
        break;
      case RoomUse::kWard:
        FurnishWard(placement);
        break;
      case RoomUse::kStore:
        Racks(placement, 1 + static_cast<int>(area / 6), 2.4);
        Cartons(placement, kit.random.Int(6));
        Cupboards(placement, kit.random.Int(2), 0.8, 2);
        break;
      case RoomUse::kHall:
        FurnishWarehouse(placement);
        break;
      case RoomUse::kGarage:
        ParkCars(placement);
        Cartons(placement, kit.random.Int(4));
        break;
      case RoomUse::kCellar:
        Racks(placement, kit.random.Int(3), 2);
        Cartons(placement, kit.random.Int(6));
        for (int i = kit.random.Int(5); i > 0; --i)
          placement.AtWall(
              0.6F, 0.6F, 0.9F, [&](const Panel& p) { AddBarrel(kit, p, 0.6F); }, 0.1F);
        Cupboards(placement, kit.random.Int(2), 0.8, 1.9);
        if (placement.Chance(0.2))
          placement.AtWall(0.6F, 0.62F, 0.9F,
                           [&](const Panel& p) { AddWashingMachine(kit, p, 0.6F, 0.6F); });
        break;
    }
  }
  FitWalls(placement, kind);
}

}  // namespace orb360::town
