#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/optimization/local_bundle_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, LocalBundleOptions* options) {
  schema->Add("bundle.max_keyframes", &options->max_keyframes,
              "keyframes that local bundle adjustment moves", 2, 1000);
  schema->Add("bundle.max_fixed_keyframes", &options->max_fixed_keyframes,
              "keyframes around them that hold the landmarks in place", 0, 1000);
  schema->Add("bundle.min_shared", &options->min_shared,
              "landmarks a keyframe must share with the newest to be moved", 1, 10000);
  schema->Add("bundle.max_iterations", &options->max_iterations,
              "iterations of local bundle adjustment", 1, 1000);
}

void RegisterHeightSigma(OptionSchema* schema, LocalBundleOptions* options) {
  schema->Add("scale.height_sigma", &options->height_sigma,
              "standard deviation of the camera's height over the ground, a fraction of it", 0.001,
              1.0);
}

}  // namespace orb360
