#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "slam/features/place_recognition.h"
#include "slam/map/map.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

struct LoopOptions {
  /// Recognise places: close loops, join maps, find a lost camera by what it sees.
  bool enabled = true;
  /// A place is looked at more closely when it is this much like the newest keyframe, as a fraction
  /// of how much the keyframe before is.
  double min_similarity = 0.25;
  /// Places looked at for each lost frame; for a keyframe it is the one most like it.
  int max_candidates = 3;
  /// Landmarks of a place that must be found in the image ...
  int min_inliers = 40;
  /// ... and the fraction of those that should be visible and are often seen: what merely looks
  /// alike shows the facades that are repeated and misses what stands around them.
  double min_found_fraction = 0.2;
  /// Keyframes that must lead to the same correction, out of twice as many in a row.
  int min_agreeing = 3;
  /// How far their corrections may differ: in position, fraction of the median range; in direction,
  /// radians; in the logarithm of the scale.
  double max_disagreement = 0.1;
  /// A loop is at least this long, multiples of the median range.
  double min_length = 5.0;
  /// What a map can have drifted: fraction of the way round, radians, a factor of scale. A street
  /// that looks like another one is farther away than that.
  double max_drift = 0.1;
  double max_turn = 0.3;
  double max_scale = 1.5;
  /// Frames after which a correction is adopted; it is computed beside tracking meanwhile.
  int correction_frames = 12;
  /// The same for the bundle adjustment of the whole map that follows, for each of its keyframes.
  double bundle_frames = 0.5;
  /// Iterations of each round of the bundle adjustment of the whole map.
  int bundle_iterations = 5;
  /// The camera's height over the ground as LocalBundleOptions::height_sigma, but less certain: all
  /// keyframes of a map hold its scale together, and a road that is not even would bend their path.
  double height_sigma = 0.02;
};

/// One keyframe that sees a place again.
struct Revisit {
  KeyframeId keyframe;
  KeyframeId place;  // a keyframe of the map that the place is in
  /// From what surrounds `keyframe` to what surrounds `place`, both in the camera's frame.
  Similarity3 place_from_keyframe;
  int shared;  // landmarks found
};

/// The camera is where it was before.
struct Loop {
  std::optional<int> finished_map;  // none: the place is in the present map
  std::vector<Revisit> revisits;    // by keyframe, the newest last
};

/// Lets a loop of the present map follow a change of its unit of length: `corrections` holds, by
/// keyframe id, what moved the world around each keyframe.
void Rescale(std::span<const Similarity3> corrections, Loop* loop);

/// What moves the world around a revisiting keyframe to where the place is.
Similarity3 CorrectionBy(const Revisit& revisit, const Map& map, const Map& place_map);

/// Recognises places by the descriptors of keyframes, and finds out whether the camera really is
/// there. Belongs to whoever has the present map.
///
/// Maps have numbers: the finished ones their index, the present one comes after them.
class LoopDetector {
 public:
  LoopDetector(const LoopOptions& options, const TrackerOptions& tracker, int local_keyframes,
               double pixel_sigma);

  /// Learns a keyframe of the present map. A loop is the result as soon as enough keyframes agree.
  std::optional<Loop> Observe(const Map& map, KeyframeId newest, std::span<const Map> finished);
  /// Learns all keyframes of a map.
  void Learn(const Map& map, int number);

  struct FoundPose {
    int map;  // number
    LocalMap local;
    TrackResult result;
  };
  /// Where a lost camera is, if the places that look most like its image tell.
  std::optional<FoundPose> FindPose(const Features& features, const Map& map,
                                    std::span<const Map> finished, int num_threads = 1) const;

  /// The present map has become another one. `number_of` gives maps their new numbers, and the
  /// keyframes of map `shifted` have ids that are larger by `shift`.
  void Renumber(std::span<const int> number_of, int shifted, KeyframeId shift);
  /// Forgets what the last keyframes have seen, after a loss.
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
  /// The `count` places most like the image, best first, with how much the mean of them and their
  /// neighbours is; without `excluded` (by place).
  std::vector<std::pair<double, int>> Rank(const std::vector<double>& scores,
                                           const std::vector<uint8_t>& excluded, int count) const;
  std::optional<TrackResult> TrackAt(const Features& features, const Map& map,
                                     const LocalMap& local, int num_threads = 1) const;
  /// The newest keyframe at a place, told from the nearest of the keyframes there that `may_close`
  /// allows.
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
  std::vector<Place> places_;        // by number in the index
  std::vector<Sighting> sightings_;  // of the last keyframes, the newest last
};

}  // namespace orb360
