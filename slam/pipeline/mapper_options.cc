#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/mapper_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, MapperOptions* options) {
  RegisterOptions(schema, &options->triangulation);
  RegisterOptions(schema, &options->bundle);
  schema->Add("mapper.max_fusion_neighbours", &options->max_fusion_neighbours,
              "keyframes with which a new one exchanges landmarks", 1, 100);
  schema->Add("mapper.redundant_fraction", &options->redundant_fraction,
              "a keyframe is dropped when three others see this fraction of its landmarks", 0.5,
              1.0);
  schema->Add("mapper.probation_keyframes", &options->probation_keyframes,
              "keyframes after which a landmark must have been seen three times", 1, 100);
  schema->Add("mapper.min_found_fraction", &options->min_found_fraction,
              "fraction of the frames in which a landmark on probation must be found", 0.0, 1.0);
  schema->Add("mapper.kept_images", &options->kept_images,
              "newest keyframes whose images are kept, to align what they show of landmarks", 1,
              1000);
}

}  // namespace orb360
