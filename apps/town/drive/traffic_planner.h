#pragma once

#include <vector>

#include "apps/town/drive/traffic.h"

namespace orb360::town {

/// Fits vehicles and people into traffic, one after the other, so that none ever collide. Objects
/// added later give way, but faster vehicles also pass slower ones that were added later.
class TrafficPlanner {
 public:
  /// Begins with the camera's car, which always stays and never waits.
  TrafficPlanner(const StreetPlan& plan, const Lap& own_lap, const Moments& moments);

  /// Adds a vehicle that passes all slower ones, is passed by all faster ones and waits for those
  /// of its pace. Returns false and changes nothing if that fails.
  bool Add(Mover mover);
  /// Returns true if no vehicle ever meets the person.
  bool IsSafe(const Walker& walker) const;

  const Moments& moments() const { return moments_; }
  const Ride& own() const { return movers_.front().ride; }
  /// Returns all vehicles except the camera's car.
  std::vector<Mover> Others() const { return {movers_.begin() + 1, movers_.end()}; }

 private:
  /// The tracks that a mover takes into account when it is planned.
  using Tracks = std::vector<const Track*>;

  /// Returns the tracks of all movers of a pace before, or up to, a given one.
  Tracks TracksBefore(Pace pace) const;
  Tracks TracksUpTo(Pace pace, const Mover* except) const;
  /// Gives the mover the passes, and the delays if it may wait, that keep it from meeting others.
  /// Returns its track, or nullopt if that fails.
  std::optional<Track> Plan(Mover* mover, const Tracks& slower, const Tracks& heeded,
                            bool may_wait) const;
  /// Adds a delay that avoids a meeting at a moment. Returns false if none does.
  bool Wait(Mover* mover, const Track& track, const Tracks& heeded, int meeting) const;
  bool StaysOnCarriageway(const Mover& mover, const Track& track) const;

  const StreetPlan* plan_;
  Moments moments_;
  std::vector<Mover> movers_;
  std::vector<Track> tracks_;
};

}  // namespace orb360::town
