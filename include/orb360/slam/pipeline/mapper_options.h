#pragma once

#include <orb360/slam/optimization/local_bundle_options.h>
#include <orb360/slam/pipeline/triangulation_options.h>

namespace orb360 {

class OptionSchema;

/// How a keyframe is integrated into the map.
struct MapperOptions {
  /// How new landmarks are triangulated.
  TriangulationOptions triangulation;
  /// How the keyframes and landmarks around a new keyframe are refined.
  LocalBundleOptions bundle;
  /// Largest number of neighbouring keyframes whose landmarks are fused with those of a new one.
  int max_fusion_neighbours = 15;
  /// A keyframe is removed as redundant when each of this fraction of its landmarks is observed by
  /// at least three others, on pyramid levels at most one coarser than its own.
  double redundant_fraction = 0.9;
  /// Number of keyframes for which a new landmark is on probation. It is removed where no third
  /// keyframe observes it by then, or where it is found too rarely (min_found_fraction).
  int probation_keyframes = 5;
  /// Least ratio of Landmark::found to Landmark::visible of a landmark on probation. What is hidden
  /// half of the time, behind leaves and posts, is worth keeping.
  double min_found_fraction = 0.1;
  /// Number of newest keyframes whose images are kept, to align what they show of landmarks.
  int kept_images = 10;
};

/// Registers the keys of the sections `triangulation`, `bundle` and `mapper`.
void RegisterOptions(OptionSchema* schema, MapperOptions* options);

}  // namespace orb360
