#include "slam/pipeline/landmark_counts.h"

#include <algorithm>
#include <iterator>

namespace orb360 {

void LandmarkCounts::Add(const TrackResult& result) {
  expected_.insert(expected_.end(), result.expected.begin(), result.expected.end());
  std::ranges::copy_if(result.landmarks, std::back_inserter(found_),
                       [](LandmarkId id) { return id != kNoId; });
}

void LandmarkCounts::Shift(LandmarkId shift) {
  for (LandmarkId& id : expected_) id += shift;
  for (LandmarkId& id : found_) id += shift;
}

void LandmarkCounts::MoveTo(Map* map) {
  for (const LandmarkId id : expected_) {
    const LandmarkId now = map->Resolve(id);
    if (now != kNoId) ++map->landmark(now).visible;
  }
  for (const LandmarkId id : found_) {
    const LandmarkId now = map->Resolve(id);
    if (now != kNoId) ++map->landmark(now).found;
  }
  Clear();
}

void LandmarkCounts::Clear() {
  expected_.clear();
  found_.clear();
}

}  // namespace orb360
