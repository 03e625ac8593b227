#include "apps/town/drive/track.h"

#include <algorithm>
#include <cmath>

namespace orb360::town {
namespace {

Track EmptyTrack(const Footprint& footprint) {
  constexpr double kAir = 0.22;  // metres around the outline's sides
  Track track;
  track.radius = 0.5 * footprint.width + kAir;
  // Length of the outline's sides before and behind its middle that a disc covers, metres.
  const double covered =
      std::sqrt(track.radius * track.radius - 0.25 * footprint.width * footprint.width);
  const double last = std::max(0.0, 0.5 * footprint.length - covered);
  const int gaps = 2 * static_cast<int>(std::ceil(0.5 * last / covered));
  for (int i = 0; i <= gaps; ++i)
    track.discs.push_back(gaps == 0 ? 0 : last * (2.0 * i / gaps - 1));
  return track;
}

}  // namespace

Track TrackOf(const Ride& ride, const Footprint& footprint, const Moments& moments) {
  Track track = EmptyTrack(footprint);
  track.positions.resize(static_cast<size_t>(moments.Count()));
  track.forwards.resize(track.positions.size());
  Retrack(ride, moments, 0, moments.Count(), &track);
  return track;
}

void Retrack(const Ride& ride, const Moments& moments, int first, int end, Track* track) {
  for (int i = first; i < end; ++i) {
    const RoadPlace place = ride.PlaceAt(moments.At(i));
    track->positions[static_cast<size_t>(i)] = place.position;
    track->forwards[static_cast<size_t>(i)] = place.forward;
  }
}

Track TrackOf(const std::function<Vector2d(double time)>& position, double radius,
              const Moments& moments) {
  Track track;
  track.radius = radius;
  track.discs = {0};
  for (int i = 0; i < moments.Count(); ++i) track.positions.push_back(position(moments.At(i)));
  track.forwards.assign(track.positions.size(), Vector2d::UnitX());
  return track;
}

std::optional<int> FirstMeeting(const Track& a, const Track& b, int first, int end) {
  const double far_apart = a.Reach() + b.Reach();
  const double touching = (a.radius + b.radius) * (a.radius + b.radius);
  for (auto i = static_cast<size_t>(first); i < static_cast<size_t>(end); ++i) {
    const Vector2d between = a.positions[i] - b.positions[i];
    if (between.squaredNorm() > far_apart * far_apart) continue;
    for (const double x : a.discs) {
      for (const double y : b.discs) {
        if ((between + x * a.forwards[i] - y * b.forwards[i]).squaredNorm() < touching)
          return static_cast<int>(i);
      }
    }
  }
  return std::nullopt;
}

std::optional<std::vector<Pass>> FindPasses(const Ride& ride, const Footprint& footprint,
                                            const std::vector<const Track*>& others,
                                            const Moments& moments) {
  constexpr double kLongest = 100;      // metres beside another
  constexpr double kSameWay = 0.7;      // least cosine between headings
  constexpr double kBehindAhead = 1.5;  // metres between bumpers when all out
  constexpr double kAir = 0.1;          // metres besides the discs' own
  const Track own = TrackOf(ride, footprint, moments);
  std::vector<Pass> passes;
  for (const Track* other : others) {
    const double near = own.Reach() + other->Reach() + kBehindAhead;
    const double lateral = own.radius + other->radius + kAir;
    bool beside = false;
    double first_along = 0;
    double last_along = 0;
    Pass pass;
    const auto finish = [&](bool at_end) {
      if (beside && first_along > 0 && (last_along < 0 || at_end)) passes.push_back(pass);
      beside = false;
    };
    for (size_t i = 0; i < own.positions.size(); ++i) {
      const Vector2d to_other = other->positions[i] - own.positions[i];
      const Vector2d& forward = own.forwards[i];
      const double along = to_other.dot(forward);
      const double right = to_other.x() * forward.y() - to_other.y() * forward.x();
      if (std::abs(along) > near || right > lateral || right < -0.5 * lateral ||
          forward.dot(other->forwards[i]) < kSameWay) {
        finish(false);
        continue;
      }
      const double distance = ride.DistanceAt(moments.At(static_cast<int>(i)));
      if (!beside) {
        beside = true;
        first_along = along;
        pass = {distance, distance, 0};
      }
      pass.end = distance;
      pass.left = std::max(pass.left, lateral - right);
      last_along = along;
    }
    finish(true);
  }
  if (std::any_of(passes.begin(), passes.end(),
                  [](const Pass& pass) { return pass.end - pass.begin > kLongest; }))
    return std::nullopt;
  return passes;
}

}  // namespace orb360::town
