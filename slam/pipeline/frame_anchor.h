#pragma once

#include <map>
#include <vector>

#include "slam/pipeline/frame_refinement.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// The pose of a frame relative to a keyframe of a map, so that the frame follows every correction
/// of the keyframe.
struct FrameAnchor {
  double timestamp = 0;  ///< Seconds.
  int map = 0;           ///< Number of the map in the atlas.
  KeyframeId reference = kNoId;
  /// Its translation is in the map's unit of length.
  Rigid3 reference_from_camera = {};
  /// Landmarks of the map from which the pose was estimated.
  std::vector<Sighting> sightings = {};
  /// Number of present units of the map in one unit of the map when the frame was anchored.
  double unit_scale = 1.0;
  /// Whether the pose lies between those of other frames, because this one showed nothing.
  bool is_interpolated = false;
};

/// The anchors of all frames that have a pose, by frame index.
using FrameAnchors = std::map<int, FrameAnchor>;

/// New numbers of maps after one has been merged into another or has exchanged places with it.
struct MapRenumbering {
  std::vector<int> number_of;  ///< New number of each map, by old number.
  int shifted = 0;             ///< Old number of the map whose ids grow.
  KeyframeId keyframe_shift = 0;
  LandmarkId landmark_shift = 0;
};

/// Gives an anchor the new numbers of its map, its keyframe and its landmarks.
inline void Renumber(const MapRenumbering& maps, FrameAnchor* anchor) {
  if (anchor->map == maps.shifted) {
    anchor->reference += maps.keyframe_shift;
    for (Sighting& sighting : anchor->sightings) sighting.landmark += maps.landmark_shift;
  }
  anchor->map = maps.number_of[anchor->map];
}

}  // namespace orb360
