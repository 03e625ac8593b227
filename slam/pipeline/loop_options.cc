#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/loop_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, LoopOptions* options) {
  schema->Add("loop.enabled", &options->enabled,
              "recognise places: close loops, merge maps, find a lost camera by its image");
  schema->Add(
      "loop.min_similarity", &options->min_similarity,
      "least similarity score of a candidate place, fraction of the score of the keyframe before",
      0.0, 10.0);
  schema->Add("loop.max_candidates", &options->max_candidates,
              "candidate places that are verified for each lost frame", 1, 100);
  schema->Add("loop.min_inliers", &options->min_inliers,
              "landmarks of a place that must be found in the image", 10, 10000);
  schema->Add("loop.min_found_fraction", &options->min_found_fraction,
              "fraction of the place's landmarks in view that must be found", 0.0, 1.0);
  schema->Add("loop.min_agreeing", &options->min_agreeing,
              "keyframes that must lead to the same correction", 1, 100);
  schema->Add("loop.max_disagreement", &options->max_disagreement,
              "difference of corrections: fraction of the median range, radians, log of the scale",
              0.0, 1.0);
  schema->Add("loop.min_length", &options->min_length,
              "least length of a loop, multiples of the median range", 0.0, 10000.0);
  schema->Add("loop.max_drift", &options->max_drift,
              "largest drift of the position, fraction of the path round the loop", 0.0, 10.0);
  schema->Add("loop.max_turn", &options->max_turn,
              "largest drift of the orientation round a loop, radians", 0.0, 3.2);
  schema->Add("loop.max_scale", &options->max_scale,
              "largest drift of the scale round a loop, a factor", 1.0, 100.0);
  schema->Add("loop.correction_frames", &options->correction_frames,
              "frames after which the correction of a loop is adopted", 1, 1000);
  schema->Add(
      "loop.bundle_frames", &options->bundle_frames,
      "frames after which a bundle adjustment of the whole map is adopted, for each keyframe", 0.0,
      100.0);
  schema->Add("loop.bundle_iterations", &options->bundle_iterations,
              "iterations of each round of the bundle adjustment of the whole map", 1, 1000);
  schema->Add("loop.height_sigma", &options->height_sigma,
              "scale.height_sigma in the bundle adjustment of the whole map", 0.001, 1.0);
}

}  // namespace orb360
