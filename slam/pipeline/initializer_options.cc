#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/initializer_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, InitializerOptions* options) {
  schema->Add("initializer.nearby_radius", &options->nearby_radius,
              "angle within which two views are matched at first, radians", 0.01, 3.2);
  schema->Add("initializer.min_landmarks", &options->min_landmarks,
              "landmarks that the first map must have", 20, 10000);
  schema->Add("initializer.min_parallax", &options->min_parallax,
              "median parallax of what is not far away in the two views, radians", 0.001, 1.0);
  schema->Add("initializer.min_parallax_sigmas", &options->min_parallax_sigmas,
              "the same, standard deviations of a feature", 0.0, 100.0);
  schema->Add("initializer.min_landmark_parallax", &options->min_landmark_parallax,
              "least parallax of a single landmark, radians", 0.001, 1.0);
  schema->Add("initializer.min_inlier_ratio", &options->min_inlier_ratio,
              "fraction of the matches that must agree with the motion", 0.1, 1.0);
}

}  // namespace orb360
