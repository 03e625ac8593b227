#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/map/map.h"
#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/frame_anchor.h"
#include "slam/pipeline/loop_detector.h"
#include "slam/pipeline/map_update.h"
#include "slam/pipeline/reconstruction.h"

namespace orb360 {

/// The present map and what recognises its places. A job that changes the map has both until it
/// ends.
struct ActiveMap {
  Map map;
  LoopDetector places;
};

/// All maps, what was anchored to them, and the scale of each. The only place where poses of the
/// past change.
///
/// Maps are numbered in the order in which they were begun. The present map, which grows, has the
/// largest number; the ones before it are finished and stay as they are while a job has the present
/// one.
class Atlas {
 public:
  explicit Atlas(LoopDetector places);

  std::span<const Map> maps() const { return maps_; }
  std::span<const Map> finished() const { return maps().first(maps_.size() - 1); }
  int present_number() const { return static_cast<int>(maps_.size()) - 1; }
  /// The present map; not while it is lent.
  Map& map();
  const Map& map() const;
  LoopDetector& places();

  /// Hands the present map to a job, and takes it back. Finished() stays valid in the meantime.
  ActiveMap Lend();
  void Return(ActiveMap active);
  bool is_lent() const { return !places_.has_value(); }

  /// Moves everything that refers to the present map, which has been changed already.
  void Apply(const MapUpdate& update);
  /// Makes a finished map the present one. The present one takes its number, without images.
  MapUpdate SwitchTo(int finished, KeyframeId reference);
  /// Finishes the present map, unless it is empty, and goes on with another.
  void Begin(Map map);
  /// Ends the present map for good, and drops it where it is empty, or lost with the job that had
  /// it, with all that was anchored to it.
  void Finish();

  /// The ground under each map, by number; where it is known, the map is in metres.
  std::span<const std::optional<KnownGround>> grounds() const { return grounds_; }
  const std::optional<KnownGround>& ground() const { return grounds_.back(); }
  void SetGround(const std::optional<KnownGround>& ground) { grounds_.back() = ground; }
  /// The same, where landmarks show it: good enough to hold the scale by.
  std::optional<KnownGround> ReliableGround() const;

  const FrameAnchors& anchors() const { return anchors_; }
  void Anchor(int frame_index, FrameAnchor anchor);

  /// A loop that was found and is not closed so far. It follows changes of the map.
  std::optional<Loop> found_loop;
  std::vector<ClosedLoop> loops;   // closed within a map
  std::vector<ClosedLoop> merges;  // by which a map was merged into an older one

 private:
  void ScaleAnchors(std::span<const Similarity3> corrections);
  void RenumberMaps(const MapRenumbering& renumbering);

  std::vector<Map> maps_;  // the last is the present one, empty while it is lent
  std::vector<std::optional<KnownGround>> grounds_;
  std::optional<LoopDetector> places_;  // none while it is lent
  FrameAnchors anchors_;
};

}  // namespace orb360
