#include "apps/town/world/tunnel/galleries.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/town/image/noise.h"
#include "apps/town/world/tunnel/surface_nets.h"

namespace orb360::town {
namespace {

constexpr float kRounding = 0.35F;  // metres, within which walls, roofs and floors merge

/// The greater of two values, without an edge where they are equal.
float SmoothMax(float a, float b, float rounding) {
  const float h = std::max(0.0F, rounding - std::abs(a - b)) / rounding;
  return std::max(a, b) + 0.25F * h * h * rounding;
}

float SmoothMin(float a, float b, float rounding) { return -SmoothMax(-a, -b, rounding); }

float DistanceToSegment(const Vector2f& p, const Vector2f& from, const Vector2f& to) {
  const Vector2f side = to - from;
  const float t = std::clamp((p - from).dot(side) / side.squaredNorm(), 0.0F, 1.0F);
  return (p - from - t * side).norm();
}

}  // namespace

Galleries::Galleries(const Trail& trail, const GalleryOptions& options, Random random)
    : options_(options), seed_(static_cast<uint32_t>(random.Next())) {
  const auto draw = [&](double low, double high) {
    return static_cast<float>(random.Uniform(low, high));
  };
  const std::vector<Vector2f>& points = trail.points();
  constexpr size_t kEvery = 4;  // points, a metre
  for (size_t i = 0; i < points.size(); i += kEvery) {
    const size_t next = i + kEvery < points.size() ? i + kEvery : 0;
    segments_.push_back({points[i], points[next], options.half_width, options.height});
  }
  const auto anywhere = [&] {
    return points[static_cast<size_t>(random.Int(static_cast<int>(points.size())))];
  };
  for (int i = 0; i < options.side_galleries; ++i) {
    Vector2f at = anywhere();
    const float half_width = options.half_width * draw(0.65, 0.95);
    const float height = options.height * draw(0.8, 0.95);
    float heading = draw(0, 2 * std::numbers::pi);
    for (int k = 3 + random.Int(5); k > 0; --k) {
      heading += draw(-0.5, 0.5);
      const Vector2f next = at + draw(2, 4) * Vector2f(std::cos(heading), std::sin(heading));
      segments_.push_back({at, next, half_width, height});
      at = next;
    }
  }
  for (int i = 0; i < options.halls; ++i)
    halls_.push_back(
        {anywhere(), options.half_width * draw(1.8, 3.2), options.height * draw(1.3, 2.2)});
  for (const Segment& segment : segments_)
    reach_ = std::max({reach_, segment.from.norm(), segment.to.norm()});
  for (const Hall& hall : halls_) reach_ = std::max(reach_, hall.centre.norm() + hall.radius);
  reach_ += options.half_width + 4 * options.roughness + 1;
}

float Galleries::Floor(const Vector2f& p) const {
  constexpr float kPeriod = 512;  // metres
  constexpr int kHills = 22;      // in the period
  return 2 * options_.slope * TiledFbm(p.x() / kPeriod, p.y() / kPeriod, kHills, 3, seed_, 0.4F);
}

Galleries::Plan Galleries::PlanAt(const Vector2f& p) const {
  constexpr float kFar = 100;  // metres
  Plan plan{kFar, 0, kFar, 0};
  for (const Segment& segment : segments_) {
    const float signed_distance =
        DistanceToSegment(p, segment.from, segment.to) - segment.half_width;
    if (signed_distance >= plan.gallery) continue;
    const float across = std::clamp(1 + signed_distance / segment.half_width, 0.0F, 1.2F);
    plan.gallery = signed_distance;
    plan.gallery_roof = segment.height - options_.arch * across * across;
  }
  for (const Hall& hall : halls_) {
    const float signed_distance = (p - hall.centre).norm() - hall.radius;
    if (signed_distance >= plan.hall) continue;
    const float across = std::clamp(1 + signed_distance / hall.radius, 0.0F, 1.2F);
    plan.hall = signed_distance;
    plan.hall_roof = hall.height * (1 - 0.6F * across * across);
  }
  return plan;
}

float Galleries::SmoothValue(const Plan& plan, float above_floor) const {
  const float gallery = SmoothMax(plan.gallery, above_floor - plan.gallery_roof, kRounding);
  const float hall = SmoothMax(plan.hall, above_floor - plan.hall_roof, kRounding);
  // The floor is the same where they meet.
  return SmoothMax(SmoothMin(gallery, hall, 2 * kRounding), -above_floor, kRounding);
}

Surface Galleries::MakeSurface() const {
  constexpr float kCell = 0.2F;  // metres
  float roof = options_.height;
  for (const Hall& hall : halls_) roof = std::max(roof, hall.height);
  const float margin = 5 * options_.roughness + 3 * kCell;
  const float low = -5 * options_.slope - margin;
  ValueGrid grid;
  grid.cell = kCell;
  grid.origin = {-reach_, -reach_, low};
  const int side = static_cast<int>(2 * reach_ / kCell) + 1;
  const int layers = static_cast<int>((roof + 5 * options_.slope + margin - low) / kCell) + 1;
  grid.size = {side, side, layers};
  grid.values.resize(grid.Index(0, 0, layers));
#pragma omp parallel for schedule(dynamic, 4)
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const Vector2f p = grid.At(x, y, 0).head<2>();
      const Plan plan = PlanAt(p);
      const float floor = Floor(p);
      for (int z = 0; z < layers; ++z) {
        const Vector3f at = grid.At(x, y, z);
        float value = SmoothValue(plan, at.z() - floor);
        if (std::abs(value) < margin) {
          // Floors are trodden: they are smoother than walls.
          constexpr float kFloor = 0.1F;
          const float wild = kFloor + (1 - kFloor) * SmoothStep(0.1F, 0.7F, at.z() - floor);
          const Vector3f q = at / 1.6F;
          // Rock is taken away, so that nothing stands or hangs in the way; the floor stays where
          // it is in the mean.
          const float noise = SpaceFbm(q.x(), q.y(), q.z(), 4, seed_ + 50, 0.55F);
          value += 2 * options_.roughness * (kFloor - wild * std::max(0.0F, 1 - noise));
        }
        grid.values[grid.Index(x, y, z)] = value;
      }
    }
  }
  return SurfaceNets(grid);
}

}  // namespace orb360::town
