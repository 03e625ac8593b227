#pragma once

#include <cstddef>
#include <string>

#include "nn/graph/json_object.h"
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// The inputs, outputs, weights and attributes of an operation in a file.
struct OperationSchema {
  const char* name;
  std::size_t least_inputs;
  std::size_t most_inputs;
  std::size_t outputs;
  bool has_weights;  // `weight` and `bias`
  Operation (*read_attributes)(JsonObject* attributes);
};

/// Throws UserError for a name that is not an operation.
const OperationSchema& SchemaOf(const std::string& operation);

}  // namespace orb360::nn
