#include "apps/town/drive/traffic_planner.h"

#include <algorithm>
#include <utility>

namespace orb360::town {

TrafficPlanner::TrafficPlanner(const StreetPlan& plan, const Lap& own_lap, const Moments& moments)
    : plan_(&plan), moments_(moments) {
  Mover own;
  own.ride.lap = &own_lap;
  own.footprint = {4.5, 1.85};  // metres, a middling car
  tracks_.push_back(TrackOf(own.ride, own.footprint, moments));
  movers_.push_back(std::move(own));
}

bool TrafficPlanner::StaysOnCarriageway(const Mover& mover, const Track& track) const {
  constexpr size_t kEvery = 3;  // moments: 0.3 s
  for (size_t i = 0; i < track.positions.size(); i += kEvery) {
    const double distance = mover.ride.DistanceAt(moments_.At(static_cast<int>(i)));
    const bool has_swerved = mover.ride.LeftAt(distance) > 0.05;
    if (has_swerved &&
        plan_->DistanceToRoad(track.positions[i]) > -0.5 * mover.footprint.width - 0.1)
      return false;
  }
  return true;
}

TrafficPlanner::Tracks TrafficPlanner::TracksBefore(Pace pace) const {
  Tracks tracks;
  for (size_t i = 0; i < movers_.size(); ++i) {
    if (movers_[i].pace < pace) tracks.push_back(&tracks_[i]);
  }
  return tracks;
}

TrafficPlanner::Tracks TrafficPlanner::TracksUpTo(Pace pace, const Mover* except) const {
  Tracks tracks;
  for (size_t i = 0; i < movers_.size(); ++i) {
    if (movers_[i].pace <= pace && &movers_[i] != except) tracks.push_back(&tracks_[i]);
  }
  return tracks;
}

bool TrafficPlanner::Wait(Mover* mover, const Track& track, const Tracks& heeded,
                          int meeting) const {
  constexpr double kBefore = 0.4;  // seconds between the end of a delay and what it is for
  const double end = moments_.At(meeting) - kBefore;
  // The first delay may begin before the moments that are compared.
  const double free_since = mover->ride.delays.empty() ? end - 1e3 : mover->ride.delays.back().end;
  Track changed = track;
  for (const int look_ahead : {70, 20}) {  // moments without a meeting after this one
    for (const double lost : {1.0, 2.0, 3.5, 5.0, 7.0, 10.0}) {
      const double begin = end - 1.55 * lost - 2.5;
      if (begin < free_since) break;
      mover->ride.delays.push_back({begin, end, lost});
      const int first = std::max(0, static_cast<int>((begin - moments_.from) / Moments::kStep));
      const int last = std::min(meeting + look_ahead, moments_.Count());
      Retrack(mover->ride, moments_, first, last, &changed);
      if (std::none_of(heeded.begin(), heeded.end(), [&](const Track* other) {
            return FirstMeeting(changed, *other, first, last).has_value();
          }))
        return true;
      mover->ride.delays.pop_back();
    }
  }
  return false;
}

std::optional<Track> TrafficPlanner::Plan(Mover* mover, const Tracks& slower, const Tracks& heeded,
                                          bool may_wait) const {
  constexpr int kMaxWaits = 12;
  mover->ride.delays.clear();
  for (int i = 0; i <= kMaxWaits; ++i) {
    mover->ride.passes.clear();
    std::optional<std::vector<Pass>> passes =
        FindPasses(mover->ride, mover->footprint, slower, moments_);
    if (!passes) return std::nullopt;
    mover->ride.passes = std::move(*passes);
    Track track = TrackOf(mover->ride, mover->footprint, moments_);
    int meeting = moments_.Count();
    for (const Track* other : heeded)
      meeting = FirstMeeting(track, *other, 0, meeting).value_or(meeting);
    if (meeting == moments_.Count()) {
      if (!StaysOnCarriageway(*mover, track)) return std::nullopt;
      return track;
    }
    if (!may_wait || !Wait(mover, track, heeded, meeting)) return std::nullopt;
  }
  return std::nullopt;
}

bool TrafficPlanner::Add(Mover mover) {
  std::optional<Track> track = Plan(&mover, TracksBefore(mover.pace),
                                    TracksUpTo(mover.pace, nullptr), mover.pace != Pace::kStanding);
  if (!track) return false;
  // Faster vehicles that meet it have to pass it.
  struct Change {
    size_t index;
    Mover mover;
    Track track;
  };
  std::vector<Change> changes;
  for (size_t i = 0; i < movers_.size(); ++i) {
    if (movers_[i].pace <= mover.pace || !Meet(tracks_[i], *track)) continue;
    Mover passing = movers_[i];
    Tracks slower = TracksBefore(passing.pace);
    Tracks heeded = TracksUpTo(passing.pace, &movers_[i]);
    slower.push_back(&*track);
    heeded.push_back(&*track);
    std::optional<Track> changed = Plan(&passing, slower, heeded, i != 0);
    if (!changed) return false;
    changes.push_back({i, std::move(passing), std::move(*changed)});
  }
  Tracks tracks;
  for (const Track& other : tracks_) tracks.push_back(&other);
  for (const Change& change : changes) tracks[change.index] = &change.track;
  for (const Change& change : changes) {
    for (size_t k = 0; k < tracks.size(); ++k) {
      if (k != change.index && Meet(change.track, *tracks[k])) return false;
    }
  }
  for (Change& change : changes) {
    movers_[change.index] = std::move(change.mover);
    tracks_[change.index] = std::move(change.track);
  }
  movers_.push_back(std::move(mover));
  tracks_.push_back(std::move(*track));
  return true;
}

bool TrafficPlanner::IsSafe(const Walker& walker) const {
  constexpr double kRadius = 0.45;  // metres
  const Track track =
      TrackOf([&](double time) { return walker.At(*plan_, time).position; }, kRadius, moments_);
  return std::none_of(tracks_.begin(), tracks_.end(),
                      [&](const Track& other) { return Meet(track, other); });
}

}  // namespace orb360::town
