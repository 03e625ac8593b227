#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/features/orb_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, OrbOptions* options) {
  schema->Add("features.count", &options->num_features, "features sought in each image", 100,
              20000);
  schema->Add("features.levels", &options->num_levels,
              "levels of the image pyramid, each 2^(1/4) times smaller than the one before", 1, 8);
  schema->Add("features.min_score", &options->min_score,
              "least difference of a corner from its surroundings, grey levels", 1, 255);
  schema->Add("features.pixel_sigma", &options->pixel_sigma,
              "standard deviation of a feature's position, pixels of its pyramid level", 0.05,
              10.0);
}

}  // namespace orb360
