#include <numbers>

#include "apps/town/world/vehicle_shape.h"

namespace orb360::town {
namespace {

constexpr float kRoundness = 4.5F;  // exponent of the plan's superellipse
constexpr float kFloor = 0.21F;     // metres, lower edge of the sills
constexpr float kPi = std::numbers::pi_v<float>;

/// A point of the outline in the plan.
struct OutlinePoint {
  float x;
  float y;
};

float Ramp(float x, float x0, float y0, float x1, float y1) {
  const float t = std::clamp((x - x0) / (x1 - x0), 0.0F, 1.0F);
  return y0 + (y1 - y0) * t * t * (3 - 2 * t);
}

/// Returns the height of the bonnet and the deck under the windows.
float DeckHeight(const VehicleShape& s, float x) {
  const float half = 0.5F * s.length;
  if (x > s.screen_base) return Ramp(x, s.screen_base, s.belt, half + 0.25F, s.nose);
  if (x < s.rear_base) return Ramp(x, s.rear_base, s.belt, -half, s.tail);
  return s.belt;
}

float ArchRadius(const VehicleShape& s) { return 1.16F * s.wheel_radius; }

/// Returns the height of the lower edge: sills, wheel arches, aprons.
float LowerEdge(const VehicleShape& s, const OutlinePoint& p) {
  const float radius = ArchRadius(s);
  for (const float axle : {s.front_axle, s.rear_axle}) {
    const float dx = std::abs(p.x - axle);
    if (dx <= radius) return s.wheel_radius + std::sqrt(radius * radius - dx * dx);
  }
  return std::abs(p.x) > s.front_axle ? kFloor + 0.03F : kFloor;
}

/// Returns the degree, in [0, 1], to which a point of the outline belongs to the nose or the tail.
float Endness(const VehicleShape& s, const OutlinePoint& p) {
  return Ramp(std::abs(p.x) / (0.5F * s.length), 0.8F, 0, 0.99F, 1);
}

/// A height on the body's skin and its distance inside the outline there.
struct ProfilePoint {
  float z;
  float inset;
};
constexpr size_t kSkinPoints = 7;

/// Returns the skin above a point of the outline, from the lower edge to the edge of the deck.
std::array<ProfilePoint, kSkinPoints> Profile(const VehicleShape& s, const OutlinePoint& p) {
  const float low = LowerEdge(s, p);
  const float top = DeckHeight(s, p.x);
  const float end = Endness(s, p);
  std::array<ProfilePoint, kSkinPoints> profile = {{{low, 0.02F},
                                                    {low + 0.06F, 0.004F},
                                                    {std::lerp(low, top, 0.48F), 0},
                                                    {top - 0.15F, 0.014F},
                                                    {top - 0.06F, 0.03F},
                                                    {top - 0.012F, 0.065F},
                                                    {top + 0.006F, 0.13F}}};
  constexpr float kBumper = 0.48F;  // metres, height of the foremost point
  for (ProfilePoint& q : profile) {
    const float off = (q.z - kBumper) / 0.45F;
    q.inset += end * (off > 0 ? 0.07F : 0.05F) * off * off;
  }
  return profile;
}

Vector3f Inset(const VehicleShape& s, const OutlinePoint& p, float inset, float z) {
  return {p.x * (1 - inset / (0.5F * s.length)), p.y * (1 - inset / (0.5F * s.width)), z};
}

/// Returns the point of the skin at height `z`.
Vector3f SkinAt(const VehicleShape& s, const OutlinePoint& p, float z) {
  const auto profile = Profile(s, p);
  size_t k = 1;
  while (k + 1 < profile.size() && profile[k].z < z) ++k;
  const float t =
      std::clamp((z - profile[k - 1].z) / (profile[k].z - profile[k - 1].z), 0.0F, 1.0F);
  return Inset(s, p, std::lerp(profile[k - 1].inset, profile[k].inset, t),
               std::lerp(profile[k - 1].z, profile[k].z, t));
}

/// Returns the outline at a parameter angle: 0 is the nose, pi / 2 the left side.
OutlinePoint OutlineAt(const VehicleShape& s, float angle) {
  const auto power = [](float x) {
    return std::copysign(std::pow(std::abs(x), 2 / kRoundness), x);
  };
  return {0.5F * s.length * power(std::cos(angle)), 0.5F * s.width * power(std::sin(angle))};
}

/// Returns the closed outline, counter-clockwise from the middle of the tail, with a fine spacing
/// at the wheel arches.
std::vector<OutlinePoint> Outline(const VehicleShape& s) {
  const float corner = 0.84F * 0.5F * s.length;
  std::vector<float> stations;
  const float radius = ArchRadius(s);
  for (const float axle : {s.rear_axle, s.front_axle}) {
    for (const float fraction :
         {-1.02F, -1.0F, -0.93F, -0.8F, -0.6F, -0.3F, 0.0F, 0.3F, 0.6F, 0.8F, 0.93F, 1.0F, 1.02F})
      stations.push_back(axle + fraction * radius);
  }
  for (int i = 1; i < 5; ++i) {
    stations.push_back(std::lerp(s.rear_axle + 1.02F * radius, s.front_axle - 1.02F * radius,
                                 static_cast<float>(i) / 5));
  }
  std::sort(stations.begin(), stations.end());
  std::erase_if(stations, [&](float x) { return std::abs(x) > corner; });
  std::vector<OutlinePoint> quarter;  // from the middle of the nose to its left corner
  constexpr int kSteps = 9;
  const float edge = HalfWidth(s, corner);
  for (int i = 0; i <= kSteps; ++i) {
    const float fraction = static_cast<float>(i) / kSteps;
    const float y =
        edge * (1.6F * fraction - 0.6F * fraction * fraction);  // closer towards the corner
    const float t = y / (0.5F * s.width);
    quarter.push_back({0.5F * s.length * std::pow(1 - std::pow(t, kRoundness), 1 / kRoundness), y});
  }
  std::vector<OutlinePoint> outline;
  for (const OutlinePoint& p : quarter) outline.push_back({-p.x, -p.y});
  for (const float x : stations) outline.push_back({x, -HalfWidth(s, x)});
  for (size_t i = quarter.size(); i-- > 1;) outline.push_back({quarter[i].x, -quarter[i].y});
  for (const OutlinePoint& p : quarter) outline.push_back(p);
  for (size_t i = stations.size(); i-- > 0;)
    outline.push_back({stations[i], HalfWidth(s, stations[i])});
  for (size_t i = quarter.size(); i-- > 0;) outline.push_back({-quarter[i].x, quarter[i].y});
  return outline;
}

/// Adds a piece of another material to the skin, between two angles of the outline and two heights.
void AddPatch(MeshBuilder& b, const VehicleShape& s, float angle0, float angle1, float z0, float z1,
              const Skin& skin) {
  constexpr int kAround = 10;
  constexpr int kUp = 4;
  constexpr float kProud = 1.005F;
  std::vector<std::vector<Vector3f>> rows;
  for (int i = 0; i <= kAround; ++i) {
    const OutlinePoint p = OutlineAt(s, std::lerp(angle0, angle1, static_cast<float>(i) / kAround));
    std::vector<Vector3f> row;
    for (int j = 0; j <= kUp; ++j) {
      const Vector3f q = SkinAt(s, p, std::lerp(z0, z1, static_cast<float>(j) / kUp));
      row.emplace_back(kProud * q.x(), kProud * q.y(), q.z());
    }
    rows.push_back(std::move(row));
  }
  AddGrid(b, rows, [&](size_t, size_t) { return skin; });
}

/// Adds a patch to either flank between two stations.
void AddFlankPatch(MeshBuilder& b, const VehicleShape& s, float x0, float x1, float z0, float z1,
                   const Skin& skin) {
  constexpr float kProud = 0.004F;  // metres
  for (const float side : {-1.0F, 1.0F}) {
    std::vector<std::vector<Vector3f>> rows;
    for (const float x : {side < 0 ? x0 : x1, side < 0 ? x1 : x0}) {
      std::vector<Vector3f> row;
      for (const float fraction : {0.0F, 0.35F, 0.7F, 1.0F}) {
        const Vector3f q = SkinAt(s, {x, side * HalfWidth(s, x)}, std::lerp(z0, z1, fraction));
        row.push_back(q + Vector3f(0, side * kProud, 0));
      }
      rows.push_back(std::move(row));
    }
    AddGrid(b, rows, [&](size_t, size_t) { return skin; });
  }
}

void AddLampsAndGrille(MeshBuilder& b, const VehicleShape& s) {
  const Materials& m = b.materials();
  const Skin black{m.rubber, {0.02F, 0.02F, 0.022F, 1}};
  const Skin clear{m.car_glass, {0.95F, 0.97F, 1, 1}};
  const Skin red{m.car_glass, {0.75F, 0.03F, 0.03F, 1}};
  const Skin amber{m.car_glass, {0.8F, 0.32F, 0.03F, 1}};
  const float nose = DeckHeight(s, 0.5F * s.length);
  const auto degrees = [](float x) { return x * kPi / 180; };
  for (const float side : {1.0F, -1.0F}) {
    const auto patch = [&](float from, float to, float z0, float z1, const Skin& skin) {
      const float a = degrees(side * from);
      const float c = degrees(side * to);
      AddPatch(b, s, std::min(a, c), std::max(a, c), z0, z1, skin);
    };
    patch(17, 42, nose - 0.22F, nose - 0.08F, clear);
    patch(42, 46, nose - 0.20F, nose - 0.1F, amber);
    patch(10, 26, 0.3F, 0.38F, black);  // fog lamps
    patch(180 - 44, 180 - 26, s.tail - 0.32F, s.tail - 0.14F, red);
    patch(180 - 26, 180 - 19, s.tail - 0.32F, s.tail - 0.2F, amber);
  }
  AddPatch(b, s, degrees(-11), degrees(11), nose - 0.2F, nose - 0.11F, black);
  AddPatch(b, s, degrees(-8), degrees(8), 0.28F, 0.4F, black);
  AddPatch(b, s, degrees(180 - 40), degrees(180 + 40), 0.27F, 0.36F, black);
  const Panel front{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  const Panel rear{{0, 0, 0}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
  b.set_tint({1, 1, 1, 1});
  const float rear_plate = std::max(s.tail - 0.46F, 0.42F);
  b.AddImage(m.number_plate, front, -0.26F, 0.26F, 0.42F, 0.53F,
             SkinAt(s, {0.5F * s.length, 0}, 0.48F).x() + 0.012F);
  b.AddImage(m.number_plate, rear, -0.26F, 0.26F, rear_plate, rear_plate + 0.11F,
             0.5F * s.length + 0.008F);
}

void AddDoors(MeshBuilder& b, const VehicleShape& s) {
  const Materials& m = b.materials();
  const Skin seam{m.rubber, {0.012F, 0.012F, 0.012F, 1}};
  const Skin strip{m.rubber, {0.03F, 0.03F, 0.032F, 1}};
  const float middle = 0.5F * (s.rear_top + s.screen_top);
  const float front = s.screen_base - 0.3F;
  const float back = std::max(s.rear_axle + 0.1F, s.rear_top + 0.15F);
  constexpr float kGap = 0.006F;  // metres, half of it
  const float high = s.belt - 0.02F;
  for (const float x : {front, middle, back}) {
    const float low = std::max(kFloor + 0.1F, LowerEdge(s, {x, 0}) + 0.03F);
    AddFlankPatch(b, s, x - kGap, x + kGap, low, high, seam);
  }
  for (const float x : {middle + 0.12F, back + 0.14F})
    AddFlankPatch(b, s, x, x + 0.16F, s.belt - 0.15F, s.belt - 0.125F, strip);
  const float arch = ArchRadius(s);
  AddFlankPatch(b, s, s.rear_axle + 1.03F * arch, s.front_axle - 1.03F * arch, kFloor,
                kFloor + 0.08F, strip);
}

}  // namespace

float HalfWidth(const VehicleShape& s, float x) {
  const float t = std::min(std::abs(x) / (0.5F * s.length), 1.0F);
  return 0.5F * s.width * std::pow(1 - std::pow(t, kRoundness), 1 / kRoundness);
}

void AddBody(MeshBuilder& b, const VehicleShape& s) {
  const Materials& m = b.materials();
  const float half = 0.5F * s.length;
  std::vector<std::vector<Vector3f>> rows;
  for (const OutlinePoint& p : Outline(s)) {
    const auto profile = Profile(s, p);
    std::vector<Vector3f> row;
    // Under the body the skin turns inward: the lining of the arches and the visible part below the
    // sills.
    row.push_back(Inset(s, p, 0.3F, profile.front().z));
    for (const ProfilePoint& q : profile) row.push_back(Inset(s, p, q.inset, q.z));
    // The deck closes over a spine along the middle, which is slightly crowned.
    const Vector3f edge = row.back();
    const Vector3f spine(std::clamp(edge.x(), -0.75F * half, 0.75F * half), 0, 0);
    for (const float fraction : {0.35F, 0.7F, 1.0F}) {
      Vector3f q = edge + fraction * (spine - edge);
      q.z() = DeckHeight(s, q.x()) + 0.006F +
              0.035F * fraction * (2 - fraction) * (1 - 0.6F * Endness(s, {q.x(), 0}));
      row.push_back(q);
    }
    rows.push_back(std::move(row));
  }
  const Skin dark{m.rubber, {0.01F, 0.01F, 0.01F, 1}};
  AddGrid(b, rows, [&](size_t, size_t j) { return j <= 1 ? dark : Skin{m.paint}; });
  AddLampsAndGrille(b, s);
  AddDoors(b, s);
}

}  // namespace orb360::town
