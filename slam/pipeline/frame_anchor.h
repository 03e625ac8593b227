#pragma once

#include <map>
#include <vector>

#include "slam/geometry/rigid3.h"
#include "slam/map/map.h"
#include "slam/pipeline/frame_refinement.h"

namespace orb360 {

/// A frame's pose relative to a keyframe of a map, so that it follows every correction of the
/// keyframe.
struct FrameAnchor {
  double timestamp = 0;  // s
  int map = 0;           // its number in the atlas
  KeyframeId reference = kNoId;
  Rigid3 reference_from_camera = {};     // translation in the map's unit
  std::vector<Sighting> sightings = {};  // landmarks of the map by which the pose was found
  /// Units of the map of today in one unit of the map when the frame was anchored.
  double unit_scale = 1.0;
};

/// The anchors of all frames that have a pose, by frame index.
using FrameAnchors = std::map<int, FrameAnchor>;

/// How maps are numbered after one has been merged into another, or changed places with it.
struct MapRenumbering {
  std::vector<int> number_of;  // new by old
  int shifted = 0;             // old number of the map whose ids grow
  KeyframeId keyframe_shift = 0;
  LandmarkId landmark_shift = 0;
};

/// Lets an anchor follow its map, its keyframe and its landmarks.
inline void Renumber(const MapRenumbering& maps, FrameAnchor* anchor) {
  if (anchor->map == maps.shifted) {
    anchor->reference += maps.keyframe_shift;
    for (Sighting& sighting : anchor->sightings) sighting.landmark += maps.landmark_shift;
  }
  anchor->map = maps.number_of[anchor->map];
}

}  // namespace orb360
