#pragma once

#include <vector>

#include "apps/town/drive/traffic.h"

namespace orb360::town {

/// Fits vehicles and people into traffic, one after the other, so that nothing ever meets: who
/// comes later gives way, but faster vehicles also pass slower ones that come later.
class TrafficPlanner {
 public:
  /// The camera's car comes first. It always stays, and never waits.
  TrafficPlanner(const StreetPlan& plan, const Lap& own_lap, const Moments& moments);

  /// Adds a vehicle that passes all slower ones, is passed by all faster ones and waits for those
  /// of its pace. False, and nothing changes, where that fails.
  bool Add(Mover mover);
  /// Whether no vehicle ever meets a person.
  bool IsSafe(const Walker& walker) const;

  const Moments& moments() const { return moments_; }
  const Ride& own() const { return movers_.front().ride; }
  /// All vehicles but the camera's car.
  std::vector<Mover> Others() const { return {movers_.begin() + 1, movers_.end()}; }

 private:
  /// What a mover heeds when it is planned.
  using Tracks = std::vector<const Track*>;

  /// The tracks of all movers of a pace before or up to a given one.
  Tracks TracksBefore(Pace pace) const;
  Tracks TracksUpTo(Pace pace, const Mover* except) const;
  /// Gives the mover the passes, and if it may wait the delays, that keep it from meeting others;
  /// its track, or none where that fails.
  std::optional<Track> Plan(Mover* mover, const Tracks& slower, const Tracks& heeded,
                            bool may_wait) const;
  /// Adds a delay that avoids a meeting at a moment; false where none does.
  bool Wait(Mover* mover, const Track& track, const Tracks& heeded, int meeting) const;
  bool StaysOnCarriageway(const Mover& mover, const Track& track) const;

  const StreetPlan* plan_;
  Moments moments_;
  std::vector<Mover> movers_;
  std::vector<Track> tracks_;
};

}  // namespace orb360::town
