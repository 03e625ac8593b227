#include "apps/town/world/tunnel/lining.h"

#include <cmath>
#include <numbers>

namespace orb360::town {

TrailFrame FrameAt(const Trail& trail, size_t point) {
  const std::vector<Vector2f>& points = trail.points();
  const size_t count = points.size();
  const Vector2f way = points[(point + 2) % count] - points[(point + count - 2) % count];
  const Vector2f along = way.normalized();
  const Vector2f& p = points[point % count];
  return {{p.x(), p.y(), 0}, {along.x(), along.y(), 0}, {along.y(), -along.x(), 0}};
}

std::vector<ProfileStrip> ArchedProfile(MaterialId wall, MaterialId arch, float half_width,
                                        float springing, float crown, int parts) {
  std::vector<ProfileStrip> profile;
  profile.push_back({wall, {half_width, 0}, {half_width, springing}});
  const auto at = [&](int i) -> Vector2f {
    const float angle =
        std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(parts);
    return {half_width * std::cos(angle), springing + (crown - springing) * std::sin(angle)};
  };
  for (int i = 0; i < parts; ++i) profile.push_back({arch, at(i), at(i + 1)});
  profile.push_back({wall, {-half_width, springing}, {-half_width, 0}});
  return profile;
}

void AddLining(const Trail& trail, const std::vector<ProfileStrip>& profile, MeshBuilder& b) {
  const size_t count = trail.points().size();
  constexpr size_t kEvery = 2;  // points, half a metre
  float around = 0;             // along the profile, metres
  for (const ProfileStrip& strip : profile) {
    const float scale = b.materials()[strip.material].tiles_per_metre;
    const float width = (strip.to - strip.from).norm();
    b.set_tint(strip.tint);
    float station = 0;
    for (size_t i = 0; i < count; i += kEvery) {
      const size_t next = i + kEvery < count ? i + kEvery : 0;
      const TrailFrame here = FrameAt(trail, i);
      const TrailFrame there = FrameAt(trail, next);
      const float length = (there.origin - here.origin).norm();
      const float low = scale * around;
      const float high = scale * (around + width);
      const float begin = scale * station;
      const float end = scale * (station + length);
      b.AddQuad(
          strip.material,
          {here.At(strip.from.x(), strip.from.y()), here.At(strip.to.x(), strip.to.y()),
           there.At(strip.to.x(), strip.to.y()), there.At(strip.from.x(), strip.from.y())},
          {Vector2f(begin, low), Vector2f(begin, high), Vector2f(end, high), Vector2f(end, low)});
      station += length;
    }
    around += width;
  }
  b.set_tint({1, 1, 1, 1});
}

}  // namespace orb360::town
