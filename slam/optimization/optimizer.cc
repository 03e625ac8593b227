#include "slam/optimization/optimizer.h"

#include "nn/base/option_schema.h"

namespace orb360 {

void RegisterOptions(OptionSchema* schema, Optimizer* optimizer) {
  schema->Add("optimizer", optimizer,
              "solver of bundle adjustment and of pose graphs; ceres is slower, to compare with",
              kOptimizerNames);
}

}  // namespace orb360
