#pragma once

#include <vector>

#include "slam/pipeline/tracker.h"
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Collects how often landmarks should have been seen and were found (Landmark::visible,
/// Landmark::found) while a job owns the map.
class LandmarkCounts {
 public:
  void Add(const TrackResult& result);
  /// Adds `shift` to the ids of the landmarks after their map was merged into another one.
  void Shift(LandmarkId shift);
  /// Adds the counts to those landmarks of the map that still exist, and clears them here.
  void MoveTo(Map* map);
  void Clear();

 private:
  std::vector<LandmarkId> expected_;
  std::vector<LandmarkId> found_;
};

}  // namespace orb360
