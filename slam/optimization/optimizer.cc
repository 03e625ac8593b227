#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/optimization/optimizer.h>

namespace orb360 {

void RegisterOptions(OptionSchema* schema, Optimizer* optimizer) {
  schema->Add("optimizer", optimizer,
              "solver of bundle adjustment and of pose graphs; ceres is slower, to compare with",
              kOptimizerNames);
}

}  // namespace orb360
