#include "apps/town/world/interior/furniture_groups.h"

#include <algorithm>
#include <numbers>

#include "apps/town/world/interior/furniture.h"
#include "apps/town/world/interior/wall_items.h"

namespace orb360::town {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

void ChairBefore(Placement& placement, const Panel& p, float x, float depth, bool office) {
  Kit& kit = placement.kit();
  const float away = placement.Draw(0.35, 0.6);
  const Panel seat = Turned(p, x + 0.25F, depth + away, kPi + placement.Draw(-0.5, 0.5));
  const Panel corner = Turned(seat, -0.25F, -0.25F, 0);
  const Area area = Placement::AreaOf(corner, 0.5F, 0.5F);
  if (!placement.IsFree(area)) return;
  if (office)
    AddOfficeChair(kit, corner);
  else
    AddChair(kit, corner);
  placement.Take(area);
}

void Plants(Placement& placement, int max) {
  Kit& kit = placement.kit();
  for (int i = kit.random.Int(max + 1); i > 0; --i) {
    const float width = placement.Draw(0.25, 0.6);
    placement.AtWall(
        width, width, 0.8F,
        [&](const Panel& p) { AddPlant(kit, p, width, placement.Draw(0.5, 1.6)); }, 0.1F);
  }
}

void Cupboards(Placement& placement, int count, double low, double high) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  for (int i = 0; i < count; ++i) {
    const float width = placement.Draw(0.4, 2);
    const float depth = placement.Draw(0.35, 0.62);
    const float height = std::min(placement.Draw(low, high), room.height - 0.1F);
    placement.AtWall(width, depth + 0.03F, height, [&](const Panel& p) {
      AddCupboard(kit, p, width, depth, height, height < 1.3F && placement.Chance(0.5));
    });
  }
}

void Bookcases(Placement& placement, int count) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  for (int i = 0; i < count; ++i) {
    const float width = placement.Draw(0.6, 2.6);
    const float depth = placement.Draw(0.24, 0.42);
    const float height = std::min(placement.Draw(0.9, 2.3), room.height - 0.1F);
    placement.AtWall(width, depth, height,
                     [&](const Panel& p) { AddBookcase(kit, p, width, depth, height); });
  }
}

void TableWithChairs(Placement& placement, double low, double high) {
  Kit& kit = placement.kit();
  const float width = placement.Draw(low, high);
  const float depth = placement.Draw(0.7, 1);
  placement.Free(width, depth, 0.5F, [&](const Panel& p) {
    AddTable(kit, p, width, depth, placement.Draw(0.72, 0.77));
    const Panel back{p.At(width, 0, depth), -p.right, p.up, -p.out};
    for (float x = 0.1F; x + 0.5F < width; x += placement.Draw(0.6, 0.75)) {
      if (placement.Chance(0.85)) ChairBefore(placement, p, x, depth - 0.15F, false);
      if (placement.Chance(0.85)) ChairBefore(placement, back, x, depth - 0.15F, false);
    }
  });
}

void Desks(Placement& placement, int count) {
  Kit& kit = placement.kit();
  for (int i = 0; i < count; ++i) {
    const float width = placement.Draw(1.2, 1.8);
    const float depth = placement.Draw(0.65, 0.85);
    const auto build = [&](const Panel& p) {
      AddDesk(kit, p, width, depth);
      ChairBefore(placement, p, 0.5F * width - 0.25F + placement.Draw(-0.15, 0.15), depth, true);
    };
    if (i % 2 == 0 && placement.AtWall(width, depth, 1.2F, build)) continue;
    placement.Free(width, depth, 0.45F, build);
  }
}

void Cartons(Placement& placement, int count) {
  Kit& kit = placement.kit();
  for (int i = 0; i < count; ++i) {
    const float width = placement.Draw(0.4, 1.5);
    const float depth = placement.Draw(0.35, 0.8);
    const float height = placement.Draw(0.25, 1.5);
    placement.AtWall(
        width, depth, height, [&](const Panel& p) { AddCartons(kit, p, width, depth, height); },
        0.03F);
  }
}

void Racks(Placement& placement, int count, double high) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  for (int i = 0; i < count; ++i) {
    const float width = placement.Draw(1, 3.2);
    const float depth = placement.Draw(0.4, 0.6);
    const float height = std::min(placement.Draw(1.6, high), room.height - 0.15F);
    placement.AtWall(
        width, depth, height, [&](const Panel& p) { AddRack(kit, p, width, depth, height); },
        0.04F);
  }
}

void Rug(Placement& placement) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  const float width = placement.Draw(1.2, 2.6);
  const float depth = placement.Draw(1, 1.8);
  const Area& a = room.area;
  if (a.width() < width + 1 || a.depth() < depth + 1) return;
  const Panel p = Turned({{a.Centre().x(), a.Centre().y(), 0},
                          Vector3f::UnitX(),
                          Vector3f::UnitZ(),
                          -Vector3f::UnitY()},
                         -0.5F * width, -0.5F * depth, placement.Draw(-0.1, 0.1));
  AddRug(kit, p, width, depth);
}

}  // namespace orb360::town
