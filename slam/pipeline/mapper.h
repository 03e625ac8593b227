#pragma once

#include "slam/map/map.h"
#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/panoramic_triangulation.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

struct MapperOptions {
  TriangulationOptions triangulation;
  LocalBundleOptions bundle;
  /// Keyframes with which a new one exchanges landmarks.
  int max_fusion_neighbours = 15;
  /// A keyframe goes when this fraction of its landmarks is seen by three others at least as well.
  double redundant_fraction = 0.9;
  /// Landmarks younger than this many keyframes are on probation: seen again by then, and found in
  /// this fraction of the frames that should show them, or removed. What is hidden half of the
  /// time, behind leaves and posts, is worth keeping.
  int probation_keyframes = 5;
  double min_found_fraction = 0.1;
  /// Images are kept of so many keyframes, the newest, to align what they show of landmarks.
  int kept_images = 10;
};

/// Takes a tracked frame into the map as a keyframe: its observations, culling of doubtful
/// landmarks, new ones by panoramic triangulation, fusion of duplicates with its neighbours,
/// alignment with the landmarks' patches and search for more of them where `image` is not null,
/// local bundle adjustment, culling of redundant keyframes. Returns the keyframe's id.
KeyframeId IntegrateKeyframe(const TrackedFrame& frame, std::shared_ptr<const SpherePyramid> image,
                             const MapperOptions& options, const std::optional<KnownGround>& ground,
                             Map* map);

}  // namespace orb360
