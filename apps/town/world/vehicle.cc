#include "apps/town/world/vehicle.h"

#include <numbers>
#include <utility>

#include "apps/town/world/vehicle_shape.h"

namespace orb360::town {
namespace {

constexpr std::array<VehicleShape, kVehicleKinds> kShapes = {{
    {4.0F, 1.74F, 0.95F, 1.47F, 0.76F, 0.98F, 0.95F, 0.1F, -1.35F, -1.86F, 0.31F, 1.24F, -1.28F,
     true},
    {4.6F, 1.80F, 0.93F, 1.44F, 0.74F, 1.02F, 0.95F, 0.1F, -0.95F, -1.7F, 0.32F, 1.42F, -1.36F,
     true},
    {4.5F, 1.86F, 1.06F, 1.68F, 0.94F, 1.12F, 1.0F, 0.3F, -1.75F, -2.1F, 0.37F, 1.4F, -1.35F, true},
    {5.2F, 1.98F, 1.2F, 2.25F, 0.98F, 1.24F, 1.9F, 1.05F, -2.4F, -2.52F, 0.35F, 1.72F, -1.66F,
     false},
    {4.7F, 1.81F, 0.94F, 1.46F, 0.75F, 1.0F, 1.0F, 0.15F, -1.7F, -2.2F, 0.32F, 1.44F, -1.4F, true},
}};

constexpr Rgba kTintedGlass{0.05F, 0.055F, 0.06F, 1};

void AddCabin(MeshBuilder& b, const VehicleShape& s) {
  const Materials& m = b.materials();
  std::vector<float> stations;
  const auto span = [&](float from, float to, int pieces) {
    for (int i = 0; i < pieces; ++i)
      stations.push_back(std::lerp(from, to, static_cast<float>(i) / static_cast<float>(pieces)));
  };
  constexpr float kPillar = 0.045F;  // metres, half its width
  const float middle = 0.5F * (s.rear_top + s.screen_top);
  const float front = s.screen_top + 0.25F * (s.screen_base - s.screen_top);
  span(s.rear_base, s.rear_top, 4);
  span(s.rear_top, s.rear_top + 0.12F, 1);
  span(s.rear_top + 0.12F, middle - kPillar, 4);
  span(middle - kPillar, middle + kPillar, 1);
  span(middle + kPillar, s.screen_top, 3);
  span(s.screen_top, front, 2);
  span(front, s.screen_base, 5);
  stations.push_back(s.screen_base);
  std::vector<std::vector<Vector3f>> rows;
  for (const float x : stations) {
    float rise = 1;
    if (x > s.screen_top)
      rise = 1 - std::pow((x - s.screen_top) / (s.screen_base - s.screen_top), 1.25F);
    if (x < s.rear_top) rise = 1 - std::pow((s.rear_top - x) / (s.rear_top - s.rear_base), 1.4F);
    rise = std::max(rise, 0.0F);
    // The roof is slightly curved from end to end.
    const float along = (x - middle) / (s.screen_base - s.rear_base);
    const float base = s.belt - 0.03F;
    const float height = (s.roof - 0.09F * along * along - base - 0.02F) * rise;
    const float w = HalfWidth(s, x) - 0.03F;
    const float lean = (s.has_rear_windows ? 0.17F : 0.08F) * rise;
    std::vector<Vector3f> row;
    const std::array<std::array<float, 2>, 6> side = {
        {{w, base},
         {(1 - 0.1F * lean) * w, base + 0.07F * height},
         {(1 - 0.85F * lean) * w, base + 0.83F * height},
         {(1 - 1.15F * lean) * w, base + 0.94F * height},
         {(0.8F - lean) * w, base + height},
         {0, base + height + 0.02F * rise}}};
    for (const auto& p : side) row.emplace_back(x, -p[0], p[1]);
    for (size_t k = side.size() - 1; k-- > 0;) row.emplace_back(x, side[k][0], side[k][1]);
    rows.push_back(std::move(row));
  }
  const Skin glass{m.car_glass, kTintedGlass};
  const Skin pillar{m.rubber, {0.015F, 0.015F, 0.015F, 1}};
  const auto between = [](float x, float low, float high) {
    return x > low - 1e-3F && x < high - 1e-3F;
  };
  AddGrid(b, rows, [&](size_t i, size_t j) {
    const float x = stations[i];
    const bool is_side = j == 1 || j == 8;
    const bool is_top = j >= 3 && j <= 6;
    if (is_side && between(x, middle - kPillar, middle + kPillar)) return pillar;
    const float last =
        s.has_rear_windows ? s.rear_base + 0.5F * (s.rear_top - s.rear_base) : middle;
    if (is_side && x > last - 1e-3F && !between(x, s.rear_top, s.rear_top + 0.12F) &&
        i + 3 < stations.size())
      return glass;
    const bool in_front = x > s.screen_top + 0.02F && i + 2 < stations.size();
    const bool behind = s.has_rear_windows && x < s.rear_top - 0.02F && i > 0;
    if (is_top && (in_front || behind)) return glass;
    return Skin{m.paint};
  });
}

/// Adds a wheel on the given side (+1 left, -1 right).
void AddWheel(MeshBuilder& b, const Vector3f& hub, float r, float side) {
  const Materials& m = b.materials();
  constexpr int kSides = 20;
  const auto at = [&](float angle, float radius, float out) {
    return Vector3f(hub.x() + radius * std::cos(angle), hub.y() + side * out,
                    hub.z() + radius * std::sin(angle));
  };
  const auto face = [&](MaterialId material, const Vector3f& p, const Vector3f& q,
                        const Vector3f& u, const Vector3f& v) {
    if (side < 0)
      b.AddFace(material, p, q, u, v);
    else
      b.AddFace(material, q, p, v, u);
  };
  const auto ring = [&](float from, float from_out, float to, float to_out, const Rgba& tint,
                        MaterialId material) {
    b.set_tint(tint);
    for (int i = 0; i < kSides; ++i) {
      const float a0 = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kSides;
      const float a1 = 2 * std::numbers::pi_v<float> * static_cast<float>(i + 1) / kSides;
      face(material, at(a0, from, from_out), at(a1, from, from_out), at(a1, to, to_out),
           at(a0, to, to_out));
    }
  };
  const Rgba tyre{0.022F, 0.022F, 0.023F, 1};
  const Rgba alloy{0.42F, 0.43F, 0.45F, 1};
  b.set_tint(tyre);
  b.AddTube(m.rubber, at(0, 0, -0.2F), at(0, 0, 0), r, r, kSides);
  ring(r, 0, 0.94F * r, 0.012F, tyre, m.rubber);
  ring(0.94F * r, 0.012F, 0.68F * r, 0.012F, tyre, m.rubber);
  ring(0.68F * r, 0.012F, 0.6F * r, 0.004F, alloy, m.trim);
  ring(0.6F * r, 0.0F, 0, -0.01F, {0.02F, 0.02F, 0.02F, 1}, m.rubber);
  ring(0.16F * r, 0.016F, 0, 0.016F, alloy, m.trim);
  b.set_tint(alloy);
  constexpr int kSpokes = 7;
  for (int i = 0; i < kSpokes; ++i) {
    const float a = 2 * std::numbers::pi_v<float> * (static_cast<float>(i) + 0.3F) / kSpokes;
    face(m.trim, at(a - 0.17F, 0.61F * r, 0.004F), at(a + 0.17F, 0.61F * r, 0.004F),
         at(a + 0.6F, 0.13F * r, 0.012F), at(a - 0.6F, 0.13F * r, 0.012F));
  }
}

void AddMirrors(MeshBuilder& b, const VehicleShape& s) {
  const Materials& m = b.materials();
  for (const float side : {1.0F, -1.0F}) {
    const float x = s.screen_base - 0.4F;
    const Vector3f root(x, side * (HalfWidth(s, x) - 0.05F), s.belt + 0.02F);
    std::vector<std::vector<Vector3f>> rows;
    constexpr int kSides = 8;
    for (const auto& [out, size] :
         {std::pair(0.0F, 0.35F), {0.06F, 0.8F}, {0.14F, 1.0F}, {0.2F, 0.8F}, {0.215F, 0.0F}}) {
      std::vector<Vector3f> row;
      for (int k = 0; k <= kSides; ++k) {
        const float a = side * 2 * std::numbers::pi_v<float> * static_cast<float>(k) / kSides;
        row.push_back(root + Vector3f(0.07F * size * std::cos(a), side * out,
                                      0.07F + 0.075F * size * std::sin(a)));
      }
      rows.push_back(std::move(row));
    }
    AddGrid(b, rows, [&](size_t, size_t) { return Skin{m.paint}; });
  }
}

/// Adds a dark octagonal plate just above the road, as the visible underside of a car.
void AddUnderside(MeshBuilder& b, const VehicleShape& s) {
  const float x = 0.46F * s.length;
  const float y = 0.42F * s.width;
  const float cut = 0.35F * s.width;
  constexpr float kHeight = 0.03F;  // metres
  b.set_tint({0.012F, 0.012F, 0.012F, 1});
  b.AddGroundPolygon(b.materials().rubber, {{x - cut, -y, kHeight},
                                            {x, cut - y, kHeight},
                                            {x, y - cut, kHeight},
                                            {x - cut, y, kHeight},
                                            {cut - x, y, kHeight},
                                            {-x, y - cut, kHeight},
                                            {-x, cut - y, kHeight},
                                            {cut - x, -y, kHeight}});
}

}  // namespace

const VehicleShape& ShapeOf(VehicleKind kind) { return kShapes[static_cast<size_t>(kind)]; }

void AddGrid(MeshBuilder& b, const std::vector<std::vector<Vector3f>>& rows,
             const std::function<Skin(size_t i, size_t j)>& skin) {
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
  for (size_t j = 0; j < columns; ++j) {
    if ((rows.front()[j] - rows.back()[j]).norm() > 1e-4F) continue;
    normals.front()[j] = normals.back()[j] = Vector3f(normals.front()[j] + normals.back()[j]);
  }
  for (size_t i = 0; i + 1 < rows.size(); ++i) {
    for (size_t j = 0; j + 1 < columns; ++j) {
      const Skin cell = skin(i, j);
      b.set_tint(cell.tint);
      std::array<uint32_t, 4> index{};
      size_t k = 0;
      for (const auto& [di, dj] : {std::pair<size_t, size_t>(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
        const Vector3f& p = rows[i + di][j + dj];
        const Vector3f& n = normals[i + di][j + dj];
        index[k++] = b.AddVertex(p, n.norm() > 1e-9F ? Vector3f(n.normalized()) : Vector3f::UnitZ(),
                                 p.x(), p.y() + p.z());
      }
      b.AddTriangle(cell.material, index[0], index[1], index[2]);
      b.AddTriangle(cell.material, index[0], index[2], index[3]);
    }
  }
}

float VehicleLength(VehicleKind kind) { return ShapeOf(kind).length; }
float VehicleWidth(VehicleKind kind) { return ShapeOf(kind).width; }

VehicleKind DrawVehicleKind(Random& random) {
  const double fraction = random.Uniform();
  if (fraction < 0.3) return VehicleKind::kHatchback;
  if (fraction < 0.5) return VehicleKind::kSaloon;
  if (fraction < 0.7) return VehicleKind::kSuv;
  return fraction < 0.86 ? VehicleKind::kEstate : VehicleKind::kVan;
}

Mesh MakeVehicle(VehicleKind kind, const Materials& materials) {
  MeshBuilder b(materials);
  const VehicleShape& s = ShapeOf(kind);
  AddBody(b, s);
  AddCabin(b, s);
  for (const float x : {s.front_axle, s.rear_axle}) {
    for (const float side : {1.0F, -1.0F})
      AddWheel(b, {x, side * (HalfWidth(s, x) - 0.03F), s.wheel_radius}, s.wheel_radius, side);
  }
  AddMirrors(b, s);
  AddUnderside(b, s);
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
