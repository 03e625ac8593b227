#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, Options* options) {
  RegisterOptions(schema, &options->mapper.bundle.optimizer);
  RegisterOptions(schema, &options->orb);
  RegisterOptions(schema, &options->initializer);
  RegisterOptions(schema, &options->tracker);
  RegisterOptions(schema, &options->keyframe);
  RegisterOptions(schema, &options->mapper);
  RegisterOptions(schema, &options->recovery);
  RegisterOptions(schema, &options->scale);
  RegisterHeightSigma(schema, &options->mapper.bundle);
  RegisterOptions(schema, &options->depth);
  RegisterOptions(schema, &options->loop);
}

}  // namespace orb360
