#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/frame_anchor.h"
#include "slam/pipeline/loop_detector.h"
#include "slam/pipeline/map_update.h"
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// The present map and the detector that recognises its places. A job that changes the map owns
/// both until it ends.
struct ActiveMap {
  Map map;
  LoopDetector places;
};

/// All maps, the frames that are anchored to them, and the ground under each map. Poses of earlier
/// frames change nowhere else.
///
/// Maps are numbered in the order in which they were begun. The present map, which grows, has the
/// largest number. The maps before it are finished; they do not change while a job owns the present
/// map.
class Atlas {
 public:
  explicit Atlas(LoopDetector places);

  std::span<const Map> maps() const { return maps_; }
  std::span<const Map> finished() const { return maps().first(maps_.size() - 1); }
  int present_number() const { return static_cast<int>(maps_.size()) - 1; }
  /// The present map. Contract: it is not lent.
  Map& map();
  const Map& map() const;
  LoopDetector& places();

  /// Hands the present map to a job, and takes it back. `finished()` stays valid in the meantime.
  ActiveMap Lend();
  void Return(ActiveMap active);
  bool is_lent() const { return !places_.has_value(); }

  /// Adapts everything that refers to the present map after that map has changed.
  void Apply(const MapUpdate& update);
  /// Makes a finished map the present one and the present one a finished one, whose images are
  /// dropped. The two exchange their numbers.
  MapUpdate SwitchTo(int finished, KeyframeId reference);
  /// Finishes the present map, unless it is empty, and makes `map` the present one.
  void Begin(Map map);
  /// Finishes the present map at the end of a run. The map is dropped, with everything that is
  /// anchored to it, where it is empty or was lost because its job threw an exception.
  void Finish();
  /// Changes the unit of length of a map at the end of a run, and of all that is anchored to it:
  /// the new one is 1 / `factor` of the old one.
  void ChangeUnit(int number, double factor);

  /// The ground under each map, by number. Where it is known, the map is in metres.
  std::span<const std::optional<KnownGround>> grounds() const { return grounds_; }
  const std::optional<KnownGround>& ground() const { return grounds_.back(); }
  void SetGround(const std::optional<KnownGround>& ground) { grounds_.back() = ground; }
  /// The ground under the present map where landmarks show it. Only then is it accurate enough to
  /// constrain the scale.
  std::optional<KnownGround> ReliableGround() const;

  const FrameAnchors& anchors() const { return anchors_; }
  void Anchor(int frame_index, FrameAnchor anchor);

  /// A loop that was found and is not closed yet. It follows changes of the map.
  std::optional<Loop> found_loop;
  std::vector<ClosedLoop> loops;   ///< Loops that were closed within a map.
  std::vector<ClosedLoop> merges;  ///< Loops by which a map was merged into an older one.

 private:
  /// Scales the anchors of a map by the corrections of their keyframes.
  void ScaleAnchors(int number, std::span<const Similarity3> corrections);
  void RenumberMaps(const MapRenumbering& renumbering);

  /// The last one is the present map. It is empty while it is lent.
  std::vector<Map> maps_;
  std::vector<std::optional<KnownGround>> grounds_;
  /// Empty while the present map is lent.
  std::optional<LoopDetector> places_;
  FrameAnchors anchors_;
};

}  // namespace orb360
