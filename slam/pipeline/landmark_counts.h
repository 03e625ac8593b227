#pragma once

#include <vector>

#include "slam/map/map.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

/// How often landmarks should have been seen, and were (Landmark::visible, Landmark::found), while
/// a job has the map.
class LandmarkCounts {
 public:
  void Add(const TrackResult& result);
  /// Lets the landmarks' ids grow, after their map was merged into another.
  void Shift(LandmarkId shift);
  /// Adds all to the landmarks of the map that still exist, and begins anew.
  void MoveTo(Map* map);
  void Clear();

 private:
  std::vector<LandmarkId> expected_;
  std::vector<LandmarkId> found_;
};

}  // namespace orb360
