#include "apps/town/world/vehicle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

namespace orb360::town {
namespace {

/// Side view and widths of a car, metres; x runs from the tail (-length / 2) to the nose.
struct Shape {
  float length;
  float width;
  float belt;  ///< height of the lower edge of the windows
  float roof;
  float nose;                     ///< height of the bonnet at the nose
  float tail;                     ///< height of the deck at the tail
  float screen_base, screen_top;  ///< x of the windscreen
  float rear_top, rear_base;      ///< x of the rear window
  float wheel_radius;
};

constexpr std::array<Shape, kVehicleKinds> kShapes = {{
    {4.0F, 1.74F, 0.95F, 1.47F, 0.74F, 0.98F, 0.85F, 0.15F, -1.45F, -1.92F, 0.31F},
    {4.6F, 1.80F, 0.93F, 1.44F, 0.72F, 0.98F, 0.95F, 0.2F, -1.0F, -1.75F, 0.32F},
    {4.5F, 1.86F, 1.08F, 1.68F, 0.92F, 1.10F, 0.95F, 0.3F, -1.85F, -2.15F, 0.37F},
    {5.2F, 1.98F, 1.25F, 2.25F, 0.95F, 1.35F, 1.9F, 1.15F, -2.45F, -2.58F, 0.35F},
}};

/// A grid of points, rows of equal length, turned into smooth-shaded quads; `material` picks one
/// for the quad between rows i, i + 1 and columns j, j + 1.
void AddGrid(MeshBuilder& b, const std::vector<std::vector<Vector3f>>& rows,
             const std::function<MaterialId(size_t i, size_t j)>& material) {
  const size_t columns = rows.front().size();
  std::vector<std::vector<Vector3f>> normals(rows.size(),
                                             std::vector<Vector3f>(columns, Vector3f::Zero()));
  for (size_t i = 0; i + 1 < rows.size(); ++i) {
    for (size_t j = 0; j + 1 < columns; ++j) {
      const Vector3f n = (rows[i + 1][j + 1] - rows[i][j]).cross(rows[i][j + 1] - rows[i + 1][j]);
      for (const auto& [di, dj] : {std::pair<size_t, size_t>(0, 0), {0, 1}, {1, 0}, {1, 1}})
        normals[i + di][j + dj] += n;
    }
  }
  for (size_t i = 0; i + 1 < rows.size(); ++i) {
    for (size_t j = 0; j + 1 < columns; ++j) {
      std::array<uint32_t, 4> index{};
      size_t k = 0;
      for (const auto& [di, dj] : {std::pair<size_t, size_t>(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
        const Vector3f& p = rows[i + di][j + dj];
        const Vector3f& n = normals[i + di][j + dj];
        index[k++] = b.AddVertex(p, n.norm() > 1e-9F ? Vector3f(n.normalized()) : Vector3f::UnitZ(),
                                 p.x(), p.y() + p.z());
      }
      b.AddTriangle(material(i, j), index[0], index[1], index[2]);
      b.AddTriangle(material(i, j), index[0], index[2], index[3]);
    }
  }
}

float Ramp(float x, float x0, float y0, float x1, float y1) {
  const float t = std::clamp((x - x0) / (x1 - x0), 0.0F, 1.0F);
  return y0 + (y1 - y0) * t * t * (3 - 2 * t);
}

/// Height of bonnet and deck under the windows.
float DeckHeight(const Shape& s, float x) {
  const float half = 0.5F * s.length;
  if (x > s.screen_base) return Ramp(x, s.screen_base, s.belt, half, s.nose);
  if (x < s.rear_base) return Ramp(x, s.rear_base, s.belt, -half, s.tail);
  return s.belt;
}

/// The body narrows in plan towards both ends.
float HalfWidth(const Shape& s, float x) {
  const float t = std::abs(x) / (0.5F * s.length);
  return 0.5F * s.width * (1 - 0.16F * std::pow(t, 5.0F));
}

void AddBody(MeshBuilder& b, const Shape& s) {
  const Materials& m = b.materials();
  constexpr float kFloor = 0.2F;
  const float half = 0.5F * s.length;
  std::vector<std::vector<Vector3f>> rows;
  constexpr int kStations = 26;
  for (int i = 0; i <= kStations; ++i) {
    const float x = half * std::sin(0.5F * std::numbers::pi_v<float> *
                                    (2.0F * static_cast<float>(i) / kStations - 1));
    const bool end = i == 0 || i == kStations;
    const float w = HalfWidth(s, x) * (end ? 0.86F : 1);
    const float deck = DeckHeight(s, x) - (end ? 0.12F : 0);
    const float low = kFloor + (end ? 0.12F : 0);
    std::vector<Vector3f> row;
    const std::array<std::array<float, 2>, 8> side = {{{0, low},
                                                       {0.9F * w, low},
                                                       {0.98F * w, low + 0.1F},
                                                       {w, 0.45F * (low + deck) + 0.1F},
                                                       {0.985F * w, deck - 0.12F},
                                                       {0.93F * w, deck - 0.03F},
                                                       {0.75F * w, deck + 0.015F},
                                                       {0, deck + 0.04F}}};
    for (const auto& p : side) row.emplace_back(x, -p[0], p[1]);
    for (size_t k = side.size() - 1; k-- > 0;) row.emplace_back(x, side[k][0], side[k][1]);
    rows.push_back(std::move(row));
  }
  // Close nose and tail with the same outline drawn in to the middle.
  const auto cap = [](const std::vector<Vector3f>& row) {
    std::vector<Vector3f> result;
    for (const Vector3f& p : row) result.emplace_back(p.x() * 1.004F, 0, 0.5F);
    return result;
  };
  rows.insert(rows.begin(), cap(rows.front()));
  rows.push_back(cap(rows.back()));
  AddGrid(b, rows, [&](size_t, size_t j) { return j <= 1 || j >= 12 ? m.rubber : m.paint; });
}

void AddCabin(MeshBuilder& b, const Shape& s) {
  const Materials& m = b.materials();
  std::vector<float> stations;
  const auto span = [&](float from, float to, int pieces) {
    for (int i = 0; i < pieces; ++i)
      stations.push_back(from + (to - from) * static_cast<float>(i) / static_cast<float>(pieces));
  };
  const float middle = 0.5F * (s.rear_top + s.screen_top);
  span(s.rear_base, s.rear_top, 4);
  span(s.rear_top, s.rear_top + 0.12F, 1);
  span(s.rear_top + 0.12F, middle - 0.05F, 4);
  span(middle - 0.05F, middle + 0.05F, 1);
  span(middle + 0.05F, s.screen_top - 0.05F, 4);
  span(s.screen_top - 0.05F, s.screen_top + 0.02F, 1);
  span(s.screen_top + 0.02F, s.screen_base, 4);
  stations.push_back(s.screen_base);
  std::vector<std::vector<Vector3f>> rows;
  for (const float x : stations) {
    float rise = 1;
    if (x > s.screen_top)
      rise = 1 - std::pow((x - s.screen_top) / (s.screen_base - s.screen_top), 1.15F);
    if (x < s.rear_top) rise = 1 - std::pow((s.rear_top - x) / (s.rear_top - s.rear_base), 1.25F);
    const float w = HalfWidth(s, x);
    const float base = s.belt - 0.04F;
    const float height = (s.roof - base) * std::max(rise, 0.0F);
    std::vector<Vector3f> row;
    const std::array<std::array<float, 2>, 5> side = {
        {{0.95F * w, base},
         {(0.95F - 0.05F * rise) * w, base + 0.08F * height},
         {(0.95F - 0.18F * rise) * w, base + 0.82F * height},
         {(0.9F - 0.22F * rise) * w, base + 0.95F * height},
         {0, base + height + 0.02F}}};
    for (const auto& p : side) row.emplace_back(x, -p[0], p[1]);
    for (size_t k = side.size() - 1; k-- > 0;) row.emplace_back(x, side[k][0], side[k][1]);
    rows.push_back(std::move(row));
  }
  const auto is_pillar = [&](float x) {
    return (x > s.rear_top - 0.01F && x < s.rear_top + 0.1F) || std::abs(x - middle) < 0.06F ||
           std::abs(x - s.screen_top) < 0.06F;
  };
  AddGrid(b, rows, [&](size_t i, size_t j) {
    const float x = stations[i];
    const bool is_side = j == 1 || j == 6;
    const bool is_top = j >= 2 && j <= 5;
    if (is_side && !is_pillar(x) && x < s.screen_base - 0.3F && x > s.rear_base + 0.15F)
      return m.car_glass;
    const bool in_front = x >= s.screen_top + 0.01F && i + 2 < stations.size();
    const bool behind = x < s.rear_top - 0.05F && i > 0;
    if (is_top && (in_front || behind)) return m.car_glass;
    return m.paint;
  });
}

void AddWheels(MeshBuilder& b, const Shape& s) {
  const Materials& m = b.materials();
  const float r = s.wheel_radius;
  const float axle = 0.5F * s.length - 0.82F;
  for (const float x : {axle, -axle}) {
    for (const float side : {1.0F, -1.0F}) {
      const float outer = side * (HalfWidth(s, x) + 0.01F);
      const float inner = outer - side * 0.22F;
      const Vector3f hub(x, outer, r);
      const auto disc = [&](float y, float from, float to, const Rgba& tint, MaterialId material) {
        b.set_tint(tint);
        constexpr int kSides = 16;
        for (int i = 0; i < kSides; ++i) {
          const float a0 = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kSides;
          const float a1 = 2 * std::numbers::pi_v<float> * static_cast<float>(i + 1) / kSides;
          const auto at = [&](float a, float radius) {
            return Vector3f(x + radius * std::cos(a), y, r + radius * std::sin(a));
          };
          if (side < 0)
            b.AddFace(material, at(a0, from), at(a1, from), at(a1, to), at(a0, to));
          else
            b.AddFace(material, at(a1, from), at(a0, from), at(a0, to), at(a1, to));
        }
      };
      b.set_tint({0.02F, 0.02F, 0.02F, 1});
      b.AddTube(m.rubber, {x, inner, r}, {x, outer + side * 0.012F, r}, r, r, 16);
      disc(outer + side * 0.012F, r, 0.62F * r, {0.025F, 0.025F, 0.025F, 1}, m.rubber);
      disc(outer + side * 0.005F, 0.62F * r, 0.2F * r, {0.35F, 0.36F, 0.38F, 1}, m.trim);
      disc(outer + side * 0.02F, 0.2F * r, 0.0F, {0.12F, 0.12F, 0.13F, 1}, m.trim);
      disc(outer + side * 0.001F, 1.17F * r, r, {0.012F, 0.012F, 0.012F, 1}, m.rubber);  // the arch
    }
  }
}

void AddDetails(MeshBuilder& b, const Shape& s) {
  const Materials& m = b.materials();
  const float half = 0.5F * s.length;
  const Vector3f up(0, 0, 1);
  const Panel front{{half + 0.005F, 0, 0}, {0, 1, 0}, up, {1, 0, 0}};
  const Panel rear{{-half - 0.005F, 0, 0}, {0, -1, 0}, up, {-1, 0, 0}};
  const float w = 0.5F * s.width * 0.84F * 0.86F;
  for (const float side : {1.0F, -1.0F}) {
    const float inner = side * (w - 0.34F);
    const float outer = side * (w + 0.03F);
    b.set_tint({0.85F, 0.87F, 0.9F, 1});
    b.AddBox(m.trim, front, std::min(inner, outer), std::max(inner, outer), s.nose - 0.24F,
             s.nose - 0.1F, -0.3F, 0.0F);
    b.set_tint({0.5F, 0.02F, 0.02F, 1});
    b.AddBox(m.trim, rear, std::min(inner, outer), std::max(inner, outer), s.tail - 0.3F,
             s.tail - 0.13F, -0.3F, 0.0F);
    // Mirrors.
    b.set_tint({0.03F, 0.03F, 0.03F, 1});
    const float mirror = side * (0.5F * s.width - 0.02F);
    const Panel back{{s.screen_base - 0.35F, mirror, s.belt}, {0, -side, 0}, up, {-1, 0, 0}};
    b.AddBox(m.trim, back, side > 0 ? -0.2F : 0.0F, side > 0 ? 0.0F : 0.2F, 0, 0.14F, -0.12F, 0);
  }
  b.set_tint({0.02F, 0.02F, 0.02F, 1});
  b.AddBox(m.trim, front, -0.45F, 0.45F, 0.42F, s.nose - 0.24F, -0.2F, 0.0F);
  b.set_tint({0.75F, 0.75F, 0.72F, 1});
  b.AddBox(m.trim, front, -0.26F, 0.26F, 0.44F, 0.55F, 0, 0.02F);
  b.AddBox(m.trim, rear, -0.26F, 0.26F, s.tail - 0.42F, s.tail - 0.31F, -0.1F, 0.01F);
}

}  // namespace

float VehicleLength(VehicleKind kind) { return kShapes[static_cast<size_t>(kind)].length; }

float VehicleWidth(VehicleKind kind) { return kShapes[static_cast<size_t>(kind)].width; }

Mesh MakeVehicle(VehicleKind kind, const Materials& materials) {
  MeshBuilder b(materials);
  const Shape& s = kShapes[static_cast<size_t>(kind)];
  b.set_tint({0.05F, 0.055F, 0.06F, 1});
  // Tints are per vertex, so the dark lower sills and the glass come out dark and paint is set to
  // white below, face by face.
  AddBody(b, s);
  AddCabin(b, s);
  for (const Triangle& triangle : b.mesh().triangles) {
    if (triangle.material != materials.paint) continue;
    for (const uint32_t index : triangle.vertices)
      b.mesh().vertices[index].tint = {255, 255, 255, 255};
  }
  AddWheels(b, s);
  AddDetails(b, s);
  return std::move(b.mesh());
}

Rgba DrawPaint(Random& random) {
  static constexpr std::array<std::array<int, 3>, 12> kColours = {{{230, 232, 232},
                                                                   {190, 194, 198},
                                                                   {150, 154, 158},
                                                                   {90, 94, 98},
                                                                   {40, 42, 46},
                                                                   {20, 20, 22},
                                                                   {120, 22, 24},
                                                                   {30, 54, 110},
                                                                   {70, 110, 150},
                                                                   {38, 70, 52},
                                                                   {170, 140, 90},
                                                                   {190, 90, 30}}};
  const auto& c =
      kColours[static_cast<size_t>(random.Chance(0.6) ? random.Int(6) : random.Int(12))];
  return Srgb(c[0], c[1], c[2]);
}

}  // namespace orb360::town
