#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/depth_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, DepthOptions* options) {
  schema->Add("depth.height", &options->height,
              "height of the images that get dense depth, pixels; they are twice as wide", 32,
              4096);
  schema->Add("depth.view_spacing", &options->view_spacing,
              "distance between views with dense depth, divided by the range around them", 0.0,
              10.0);
  schema->Add("depth.min_points", &options->min_points,
              "landmarks that a view must show to be completed, unless stereo measures it", 1,
              100000);
  schema->Add("depth.adoption_frames", &options->adoption_frames,
              "frames after which the depth of a keyframe is used in mapping", 1, 1000);
  schema->Add("depth.guides_mapping", &options->guides_mapping,
              "use completed ranges in mapping and tracking");
  schema->Add("depth.stereo", &options->stereo,
              "measure ranges by multi-view stereo at the end of a run");
  schema->Add("depth.completion", &options->completion,
              "let the network complete what stereo does not see");
}

}  // namespace orb360
