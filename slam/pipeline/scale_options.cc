#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/scale_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, ScaleOptions* options) {
  schema->Add(
      "camera.height_m", &options->camera_height,
      "height of the camera over the ground, metres: what makes the result metric; 0: as the "
      "input says, or 1.6",
      0.0, 100.0);
  schema->Add("camera.height_sigma", &options->camera_height_sigma,
              "standard deviation of camera.height_m, a fraction of it", 0.001, 1.0);
  schema->Add("scale.from_ground", &options->from_ground,
              "find the ground below the camera and keep the scale by it");
}

}  // namespace orb360
