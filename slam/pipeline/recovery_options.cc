#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/recovery_options.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, RecoveryOptions* options) {
  schema->Add("recovery.patience_frames", &options->patience_frames,
              "frames after a loss before a new map may be begun", 1, 100000);
  schema->Add("recovery.keyframes_per_frame", &options->keyframes_per_frame,
              "keyframes in which a lost frame is sought", 1, 1000);
  schema->Add("recovery.max_pending_frames", &options->max_pending_frames,
              "frames without a pose that are remembered to be tracked later", 1, 100000);
}

}  // namespace orb360
