#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "slam/features/place_recognition.h"
#include "slam/pipeline/loop.h"
#include "slam/pipeline/tracker.h"
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/loop_options.h>

namespace orb360 {

/// Recognises places by the descriptors of keyframes and verifies them geometrically. It is owned
/// together with the present map (ActiveMap).
///
/// The number of a finished map is its index; the present map has the number after them.
class LoopDetector {
 public:
  LoopDetector(const LoopOptions& options, const TrackerOptions& tracker, int local_keyframes,
               double pixel_sigma);

  /// Adds a keyframe of the present map. Returns a loop as soon as enough keyframes agree on it.
  std::optional<Loop> Observe(const Map& map, KeyframeId newest, std::span<const Map> finished);
  /// Adds all keyframes of a map.
  void Learn(const Map& map, int number);

  struct FoundPose {
    int map;  ///< Number of the map.
    LocalMap local;
    TrackResult result;
  };
  /// Returns the pose of a lost camera if it is found at one of the places that are most similar to
  /// its image.
  std::optional<FoundPose> FindPose(const Features& features, const Map& map,
                                    std::span<const Map> finished, int num_threads = 1) const;

  /// Adapts the places after the present map has changed to another one. `number_of` contains the
  /// new numbers of the maps, and the ids of the keyframes of map `shifted` grow by `shift`.
  void Renumber(std::span<const int> number_of, int shifted, KeyframeId shift);
  /// Forgets the sightings of the last keyframes after tracking was lost.
  void Restart() { sightings_.clear(); }

 private:
  struct Place {
    int map;
    KeyframeId keyframe;
  };
  struct Sighting {
    std::optional<int> finished_map;
    Revisit revisit;
  };
  void Learn(const Keyframe& keyframe, int number);
  /// Returns the `count` places with the highest similarity scores, best first. The score of a
  /// place is the mean over the place and its neighbours. Places that `excluded` marks are left
  /// out.
  std::vector<std::pair<double, int>> Rank(const std::vector<double>& scores,
                                           const std::vector<uint8_t>& excluded, int count) const;
  std::optional<TrackResult> TrackAt(const Features& features, const Map& map,
                                     const LocalMap& local, int num_threads = 1) const;
  /// Returns the pose of the newest keyframe at a place, relative to the nearest of the keyframes
  /// there that `may_close` allows.
  std::optional<Revisit> Verify(const Map& map, KeyframeId newest, const Map& place_map,
                                KeyframeId place,
                                const std::function<bool(KeyframeId)>& may_close) const;
  std::optional<Loop> Confirm(const Map& map, const Sighting& sighting,
                              std::span<const Map> finished);

  LoopOptions options_;
  TrackerOptions tracker_;
  int local_keyframes_;
  double pixel_sigma_;
  PlaceIndex index_;
  std::vector<Place> places_;        ///< By number in the index.
  std::vector<Sighting> sightings_;  ///< Of the last keyframes, in their order.
};

}  // namespace orb360
