#include "apps/town/world/interior/room_shell.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace orb360::town {
namespace {

constexpr std::array<Side, 4> kSides = {Side::kSouth, Side::kEast, Side::kNorth, Side::kWest};

void Paint(MeshBuilder& b, const Coat& coat) { b.set_tint(coat.tint); }

/// A hole on the panel of its wall.
struct PanelHole {
  float left, right, low, high;
  bool is_window;
};

std::vector<PanelHole> HolesOnPanel(const Room& room, Side side) {
  std::vector<PanelHole> holes;
  for (const WallHole& hole : room.holes[static_cast<size_t>(side)]) {
    const float a = room.OnPanel(side, hole.begin);
    const float c = room.OnPanel(side, hole.end);
    holes.push_back({std::min(a, c), std::max(a, c), hole.low, hole.high, hole.is_window});
  }
  std::ranges::sort(holes, {}, &PanelHole::left);
  return holes;
}

/// Adds the part of a wall between two heights, without its holes.
void AddWallBand(MeshBuilder& b, const Coat& coat, const Panel& p, float length,
                 const std::vector<PanelHole>& holes, float low, float high) {
  Paint(b, coat);
  float left = 0;
  for (const PanelHole& hole : holes) {
    b.AddRectangle(coat.material, p, left, hole.left, low, high);
    b.AddRectangle(coat.material, p, hole.left, hole.right, low,
                   std::min(high, std::max(low, hole.low)));
    b.AddRectangle(coat.material, p, hole.left, hole.right,
                   std::max(low, std::min(high, hole.high)), high);
    left = hole.right;
  }
  b.AddRectangle(coat.material, p, left, length, low, high);
}

void AddSkirting(MeshBuilder& b, const Finishes& f, const Panel& p, float length,
                 const std::vector<PanelHole>& holes) {
  if (f.skirting <= 0) return;
  constexpr float kThickness = 0.014F;  // metres
  Paint(b, f.woodwork);
  float left = 0;
  for (const PanelHole& hole : holes) {
    if (hole.low > f.skirting) continue;
    b.AddBox(f.woodwork.material, p, left, hole.left, 0, f.skirting, 0, kThickness);
    left = hole.right;
  }
  b.AddBox(f.woodwork.material, p, left, length, 0, f.skirting, 0, kThickness);
}

/// Adds reveals, sill, frame and glazing bars of a window in an outer wall.
void AddWindowFittings(MeshBuilder& b, const Finishes& f, const Panel& p, const PanelHole& hole,
                       float wall, Random& random) {
  const auto& [x0, x1, z0, z1, is_window] = hole;
  Paint(b, f.wall);
  const MaterialId w = f.wall.material;
  b.AddFace(w, p.At(x0, z0, 0), p.At(x0, z1, 0), p.At(x0, z1, -wall), p.At(x0, z0, -wall));
  b.AddFace(w, p.At(x1, z1, 0), p.At(x1, z0, 0), p.At(x1, z0, -wall), p.At(x1, z1, -wall));
  b.AddFace(w, p.At(x0, z1, 0), p.At(x1, z1, 0), p.At(x1, z1, -wall), p.At(x0, z1, -wall));
  b.AddFace(w, p.At(x1, z0, 0), p.At(x0, z0, 0), p.At(x0, z0, -wall), p.At(x1, z0, -wall));
  Paint(b, f.woodwork);
  const MaterialId frame = f.woodwork.material;
  if (random.Chance(0.7))
    b.AddBox(frame, p, x0 - 0.04F, x1 + 0.04F, z0 - 0.03F, z0 + 0.004F, -0.02F, 0.05F);
  const auto bar = [&](float left, float right, float low, float high) {
    b.AddBox(frame, p, left, right, low, high, -wall + 0.02F, -wall + 0.08F);
    b.AddFace(frame, p.At(left, low, -wall + 0.08F), p.At(right, low, -wall + 0.08F),
              p.At(right, low, -wall + 0.02F), p.At(left, low, -wall + 0.02F));
  };
  constexpr float kBar = 0.06F;  // metres
  bar(x0, x0 + kBar, z0, z1);
  bar(x1 - kBar, x1, z0, z1);
  bar(x0 + kBar, x1 - kBar, z0, z0 + kBar);
  bar(x0 + kBar, x1 - kBar, z1 - kBar, z1);
  const int panes =
      std::max(1, static_cast<int>(std::lround((x1 - x0) / random.Uniform(0.5, 1.1))));
  for (int i = 1; i < panes; ++i) {
    const float x = x0 + (x1 - x0) * static_cast<float>(i) / static_cast<float>(panes);
    bar(x - 0.03F, x + 0.03F, z0 + kBar, z1 - kBar);
  }
  if (random.Chance(0.4)) {
    const float z = z0 + static_cast<float>(random.Uniform(0.55, 0.8)) * (z1 - z0);
    bar(x0 + kBar, x1 - kBar, z - 0.02F, z + 0.02F);
  }
}

/// The frame of a ceiling that rises: x across, y along its ridge.
struct Raised {
  Vector3f origin, across, along;
  float width, length;

  Vector3f At(float x, float y, float z) const {
    return origin + x * across + y * along + z * Vector3f::UnitZ();
  }
};

/// Adds a vault or a gable over the walls, and the ends of the walls below it.
void AddRaisedCeiling(const Room& room, const Finishes& f, MeshBuilder& b) {
  const Area& a = room.area;
  const bool is_along_x = a.width() >= a.depth();
  const Raised r = is_along_x ? Raised{{a.x1, a.y0, room.height},
                                       Vector3f::UnitY(),
                                       -Vector3f::UnitX(),
                                       a.depth(),
                                       a.width()}
                              : Raised{{a.x0, a.y0, room.height},
                                       Vector3f::UnitX(),
                                       Vector3f::UnitY(),
                                       a.width(),
                                       a.depth()};
  const bool is_vault = room.ceiling == CeilingKind::kVault;
  const int strips = is_vault ? 20 : 2;
  const auto height = [&](int i) {
    const float t = 2 * static_cast<float>(i) / static_cast<float>(strips) - 1;
    return room.rise * (is_vault ? std::sqrt(std::max(0.0F, 1 - t * t)) : 1 - std::abs(t));
  };
  for (int i = 0; i < strips; ++i) {
    const float x0 = r.width * static_cast<float>(i) / static_cast<float>(strips);
    const float x1 = r.width * static_cast<float>(i + 1) / static_cast<float>(strips);
    const float z0 = height(i);
    const float z1 = height(i + 1);
    Paint(b, f.ceiling);
    b.set_texture_origin({0, x0});
    b.AddFace(f.ceiling.material, r.At(x0, 0, z0), r.At(x0, r.length, z0), r.At(x1, r.length, z1),
              r.At(x1, 0, z1));
    b.set_texture_origin({0, 0});
    Paint(b, f.wall);
    // The ends: strips from the walls' top up to the ceiling.
    b.AddFace(f.wall.material, r.At(x1, 0, 0), r.At(x0, 0, 0), r.At(x0, 0, z0), r.At(x1, 0, z1));
    b.AddFace(f.wall.material, r.At(x0, r.length, 0), r.At(x1, r.length, 0), r.At(x1, r.length, z1),
              r.At(x0, r.length, z0));
  }
}

void AddFlatCeiling(const Room& room, const Finishes& f, Random& random, MeshBuilder& b) {
  const Area& a = room.area;
  const Panel below{
      {a.x0, a.y0, room.height}, Vector3f::UnitY(), Vector3f::UnitX(), -Vector3f::UnitZ()};
  Paint(b, f.ceiling);
  b.AddRectangle(f.ceiling.material, below, 0, a.depth(), 0, a.width());
  if (room.ceiling != CeilingKind::kBeams) return;
  const bool large = room.height > 4 || a.width() * a.depth() > 150;
  const auto pitch = static_cast<float>(large ? random.Uniform(3, 6) : random.Uniform(0.6, 1.2));
  const auto half =
      static_cast<float>(large ? random.Uniform(0.12, 0.25) : random.Uniform(0.05, 0.1));
  const auto deep =
      static_cast<float>(large ? random.Uniform(0.2, 0.5) : random.Uniform(0.08, 0.16));
  const bool is_along_y = a.width() >= a.depth();
  const Coat coat = large ? f.ceiling : Coat{f.woodwork.material, {0.45F, 0.3F, 0.18F, 1}};
  Paint(b, coat);
  const float room_left = std::min(deep, room.height - 1.95F);
  for (float at = 0.5F * pitch; at < (is_along_y ? a.width() : a.depth()) - half; at += pitch) {
    if (is_along_y)
      b.AddBox(coat.material, below, 0, a.depth(), at - half, at + half, 0, room_left);
    else
      b.AddBox(coat.material, below, at - half, at + half, 0, a.width(), 0, room_left);
  }
}

void AddBlocks(const Room& room, const Finishes& f, MeshBuilder& b) {
  for (const Area& block : room.blocks) {
    Room inside_out;  // the walls of a room with its area, seen from outside
    inside_out.area = block;
    for (const Side side : kSides) {
      const Panel wall = inside_out.Wall(side);
      const float length = inside_out.WallLength(side);
      const Panel face{wall.At(length, 0), -wall.right, wall.up, -wall.out};
      Paint(b, f.wall);
      b.AddRectangle(f.wall.material, face, 0, length, f.lower_height, room.height);
      if (f.lower_height > 0) {
        Paint(b, f.lower_wall);
        b.AddRectangle(f.lower_wall.material, face, 0, length, 0, f.lower_height);
      }
      if (f.skirting > 0) {
        Paint(b, f.woodwork);
        b.AddBox(f.woodwork.material, face, -0.014F, length + 0.014F, 0, f.skirting, 0, 0.014F);
      }
    }
    const float x0 = block.x0;
    Paint(b, f.wall);
    b.AddFace(f.wall.material, {x0, block.y0, room.height}, {block.x1, block.y0, room.height},
              {block.x1, block.y1, room.height}, {x0, block.y1, room.height});
  }
}

}  // namespace

void AddRoomShell(const FloorPlan& plan, const Room& room, const Finishes& f, Random& random,
                  MeshBuilder& b, std::vector<Lamp>* lamps) {
  const Area& a = room.area;
  Paint(b, f.floor);
  const bool turned = random.Chance(0.5);
  const Panel floor =
      turned ? Panel{{a.x0, a.y0, 0}, Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ()}
             : Panel{{a.x1, a.y0, 0}, Vector3f::UnitY(), -Vector3f::UnitX(), Vector3f::UnitZ()};
  b.AddRectangle(f.floor.material, floor, 0, turned ? a.width() : a.depth(), 0,
                 turned ? a.depth() : a.width());
  if (room.rise > 0)
    AddRaisedCeiling(room, f, b);
  else
    AddFlatCeiling(room, f, random, b);
  AddBlocks(room, f, b);
  for (const Side side : kSides) {
    const Panel wall = room.Wall(side);
    const float length = room.WallLength(side);
    const std::vector<PanelHole> holes = HolesOnPanel(room, side);
    const float lower = std::min(f.lower_height, room.height);
    AddWallBand(b, f.wall, wall, length, holes, lower, room.height);
    if (lower > 0) AddWallBand(b, f.lower_wall, wall, length, holes, 0, lower);
    AddSkirting(b, f, wall, length, holes);
    for (const PanelHole& hole : holes) {
      if (!hole.is_window) continue;
      AddWindowFittings(b, f, wall, hole, plan.outer_wall, random);
      lamps->push_back({wall.At(hole.left, hole.low, 0.005F - plan.outer_wall),
                        (hole.right - hole.left) * wall.right, (hole.high - hole.low) * wall.up,
                        Vector3f::Zero(), true});
    }
  }
}

std::vector<Area> AddDoorway(const Doorway& way, const Finishes& f, Random& random,
                             MeshBuilder& b) {
  const Vector3f through = way.along_x ? Vector3f::UnitX() : Vector3f::UnitY();
  const Vector3f across = way.along_x ? Vector3f::UnitY() : Vector3f::UnitX();
  // A corner of the passage by its distances across and through, and its height.
  const auto at = [&](float x, float y, float z) -> Vector3f {
    return x * across + y * through + z * Vector3f::UnitZ();
  };
  const auto face = [&](MaterialId material, const Vector3f& p, const Vector3f& q,
                        const Vector3f& r, const Vector3f& s) {
    if (way.along_x)
      b.AddFace(material, s, r, q, p);
    else
      b.AddFace(material, p, q, r, s);
  };
  const auto& [begin, end, near, far, top] =
      std::tuple(way.begin, way.end, way.near, way.far, way.height);
  const bool has_frame = random.Chance(0.8);
  const Coat lining = has_frame ? f.woodwork : f.wall;
  Paint(b, lining);
  face(lining.material, at(begin, near, 0), at(begin, far, 0), at(begin, far, top),
       at(begin, near, top));
  face(lining.material, at(end, far, 0), at(end, near, 0), at(end, near, top), at(end, far, top));
  face(lining.material, at(begin, far, top), at(end, far, top), at(end, near, top),
       at(begin, near, top));
  Paint(b, f.floor);
  face(f.floor.material, at(begin, near, 0), at(end, near, 0), at(end, far, 0), at(begin, far, 0));
  const Panel far_wall{at(0, far, 0), way.along_x ? Vector3f(across) : Vector3f(-across),
                       Vector3f::UnitZ(), through};
  const Panel near_side{at(0, near, 0), -far_wall.right, Vector3f::UnitZ(), -through};
  if (has_frame) {
    Paint(b, f.woodwork);
    const auto wide = static_cast<float>(random.Uniform(0.05, 0.1));
    for (const Panel* side : {&near_side, &far_wall}) {
      const float sign = side->right.dot(across) > 0 ? 1.0F : -1.0F;
      const float left = std::min(sign * begin, sign * end);
      const float right = std::max(sign * begin, sign * end);
      b.AddBox(f.woodwork.material, *side, left - wide, left, 0, top + wide, 0, 0.018F);
      b.AddBox(f.woodwork.material, *side, right, right + wide, 0, top + wide, 0, 0.018F);
      b.AddBox(f.woodwork.material, *side, left, right, top, top + wide, 0, 0.018F);
    }
  }
  if (!random.Chance(0.65) || way.end - way.begin > 1.5F) return {};
  // The leaf stands open on the side with the larger coordinates, at right angles to the wall or
  // nearly folded back.
  constexpr float kThickness = 0.04F;  // metres
  const float width = way.end - way.begin - 0.02F;
  const bool at_end = random.Chance(0.5);
  const float hinge = at_end ? end + 0.5F * kThickness : begin - 0.5F * kThickness;
  const auto angle = static_cast<float>(random.Uniform(0, 0.5));  // beyond the right angle
  const float away = at_end ? std::sin(angle) : -std::sin(angle);
  const Vector3f along = away * across + std::cos(angle) * through;
  const Vector3f start = at(hinge, far + 0.02F, 0.01F);
  const Vector3f out = along.cross(Vector3f::UnitZ());
  const Coat leaf = random.Chance(0.5)
                        ? f.woodwork
                        : Coat{random.Chance(0.3) ? b.materials().doors[0] : f.woodwork.material,
                               {0.8F, 0.7F, 0.55F, 1}};
  Paint(b, leaf);
  for (const float side : {1.0F, -1.0F}) {
    const Panel p{start + (side > 0 ? Vector3f(Vector3f::Zero()) : Vector3f(width * along)),
                  side * along, Vector3f::UnitZ(), side * out};
    Paint(b, leaf);
    b.AddBox(leaf.material, p, 0, width, 0, top - 0.03F, -0.5F * kThickness, 0.5F * kThickness);
    // Raised panels and the handle.
    const float handle = side > 0 ? width - 0.08F : 0.08F;
    b.AddBox(leaf.material, p, 0.12F, width - 0.12F, 0.15F, 0.85F, 0.5F * kThickness,
             0.5F * kThickness + 0.006F);
    b.AddBox(leaf.material, p, 0.12F, width - 0.12F, 1.05F, top - 0.2F, 0.5F * kThickness,
             0.5F * kThickness + 0.006F);
    b.set_tint({0.45F, 0.44F, 0.42F, 1});
    b.AddTube(b.materials().trim, p.At(handle, 1, 0.02F), p.At(handle, 1, 0.07F), 0.01F, 0.01F, 8);
    b.AddTube(b.materials().trim, p.At(handle, 1, 0.06F),
              p.At(handle + (side > 0 ? -0.11F : 0.11F), 1, 0.06F), 0.009F, 0.009F, 8);
  }
  const Vector3f tip = start + width * along;
  return {Area{std::min(start.x(), tip.x()), std::max(start.x(), tip.x()),
               std::min(start.y(), tip.y()), std::max(start.y(), tip.y())}
              .Grown(0.03F)};
}

}  // namespace orb360::town
