#pragma once

#include <orb360/slam/optimization/local_bundle_options.h>
#include <orb360/slam/pipeline/triangulation_options.h>

namespace orb360 {

class OptionSchema;

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

/// Registers the keys of the sections `triangulation`, `bundle` and `mapper`.
void RegisterOptions(OptionSchema* schema, MapperOptions* options);

}  // namespace orb360
