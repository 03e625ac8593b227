#pragma once

#include <cstddef>
#include <string>

#include "nn/graph/graph.h"
#include "nn/graph/json_object.h"

namespace orb360::nn {

/// What a node of an operation looks like in a file.
struct OperationSchema {
  const char* name;
  std::size_t least_inputs;
  std::size_t most_inputs;
  std::size_t outputs;
  bool has_weights;  // `weight` and `bias`
  Operation (*read_attributes)(JsonObject* attributes);
};

/// Throws UserError for a name that no operation has.
const OperationSchema& SchemaOf(const std::string& operation);

}  // namespace orb360::nn
