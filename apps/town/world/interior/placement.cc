#include "apps/town/world/interior/placement.h"

#include <algorithm>
#include <numbers>

namespace orb360::town {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kDoorGround = 0.9F;  // metres before a door that stay free

}  // namespace

Placement::Placement(Kit& kit, const FloorPlan& plan, const Room& room, std::vector<Area>* taken)
    : kit_(kit), room_(room), taken_(taken) {
  for (const Doorway& way : plan.doorways) {
    Area ground = way.Floor().Grown(0.1F);
    (way.along_x ? ground.x0 : ground.y0) -= kDoorGround;
    (way.along_x ? ground.x1 : ground.y1) += kDoorGround;
    doors_.push_back(ground);
  }
}

bool Placement::IsFree(const Area& area) const {
  const Area& a = room_.area;
  constexpr float kRounding = 1e-3F;
  if (area.x0 < a.x0 - kRounding || area.x1 > a.x1 + kRounding || area.y0 < a.y0 - kRounding ||
      area.y1 > a.y1 + kRounding)
    return false;
  const auto meets = [&](const Area& other) { return other.Overlaps(area); };
  return std::ranges::none_of(doors_, meets) && std::ranges::none_of(room_.blocks, meets) &&
         std::ranges::none_of(*taken_, meets);
}

Area Placement::AreaOf(const Panel& p, float width, float depth) {
  Area area{1e9F, -1e9F, 1e9F, -1e9F};
  for (const float x : {0.0F, width}) {
    for (const float d : {0.0F, depth}) {
      const Vector3f corner = p.At(x, 0, d);
      area = {std::min(area.x0, corner.x()), std::max(area.x1, corner.x()),
              std::min(area.y0, corner.y()), std::max(area.y1, corner.y())};
    }
  }
  return area;
}

std::optional<Panel> Placement::AtWall(float width, float depth, float height, const Build& build,
                                       float gap) {
  for (int attempt = 0; attempt < 14; ++attempt) {
    const auto side = static_cast<Side>(kit_.random.Int(4));
    const float length = room_.WallLength(side);
    if (length < width + 0.05F) continue;
    const bool in_corner = Chance(0.4);
    const float x = in_corner ? (Chance(0.5) ? 0.02F : length - width - 0.02F)
                              : Draw(0.02, length - width - 0.02F);
    const Panel wall = room_.Wall(side);
    bool is_before_hole = false;
    for (const WallHole& hole : room_.holes[static_cast<size_t>(side)]) {
      const float h0 = room_.OnPanel(side, hole.begin);
      const float h1 = room_.OnPanel(side, hole.end);
      is_before_hole |=
          std::min(h0, h1) < x + width + 0.05F && std::max(h0, h1) > x - 0.05F && hole.low < height;
    }
    if (is_before_hole) continue;
    const Panel p = Turned(wall, x, gap, 0);
    const Area area = AreaOf(p, width, depth);
    if (!IsFree(area)) continue;
    Take(area);
    build(p);
    walls_[static_cast<size_t>(side)].push_back({x, x + width, height});
    return p;
  }
  return std::nullopt;
}

bool Placement::Free(float width, float depth, float keep, const Build& build, float turn) {
  for (int attempt = 0; attempt < 10; ++attempt) {
    const Area& a = room_.area;
    const float reach = 0.5F * std::min(width, depth) + keep;
    if (a.width() < 2 * reach || a.depth() < 2 * reach) return false;
    const float x = Draw(a.x0 + reach, a.x1 - reach);
    const float y = Draw(a.y0 + reach, a.y1 - reach);
    const float angle = turn > 0 ? turn * static_cast<float>(kit_.random.Int(4)) : Draw(0, 2 * kPi);
    const Panel middle =
        Turned({{x, y, 0}, Vector3f::UnitX(), Vector3f::UnitZ(), -Vector3f::UnitY()}, 0, 0, angle);
    const Panel p = Turned(middle, -0.5F * width, -0.5F * depth, 0);
    const Area area = AreaOf(p, width, depth);
    if (!IsFree(area.Grown(keep))) continue;
    Take(area);
    build(p);
    return true;
  }
  return false;
}

}  // namespace orb360::town
