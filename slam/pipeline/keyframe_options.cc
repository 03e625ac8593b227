#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/keyframe_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, KeyframeOptions* options) {
  schema->Add("keyframe.min_tracked_fraction", &options->min_tracked_fraction,
              "a new keyframe when fewer of its reference's landmarks are tracked", 0.0, 1.0);
  schema->Add("keyframe.max_motion", &options->max_motion,
              "a new keyframe after moving this fraction of the surroundings' median range", 0.0,
              10.0);
  schema->Add("keyframe.min_motion", &options->min_motion,
              "no new keyframe before moving this fraction of the surroundings' median range", 0.0,
              10.0);
  schema->Add("keyframe.mapping_frames", &options->mapping_frames,
              "frames after which the mapping of a keyframe is adopted", 1, 100);
  schema->Add("keyframe.min_held_fraction", &options->min_held_fraction,
              "earlier when fewer of its landmarks are still tracked", 0.0, 1.0);
  schema->Add("keyframe.urgent_inliers", &options->urgent_inliers,
              "with fewer tracked landmarks a keyframe is made, and adopted at once", 0, 10000);
  schema->Add("keyframe.local_keyframes", &options->local_keyframes,
              "neighbouring keyframes whose landmarks are searched in each frame", 1, 1000);
}

}  // namespace orb360
