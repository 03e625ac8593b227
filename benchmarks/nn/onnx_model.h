#pragma once

#include <string>

#include "benchmarks/nn/contender.h"

namespace orb360::nn {

/// The bytes of an ONNX model of one convolution, from tensor "x" to tensor "y".
std::string OnnxModel(const Problem& problem);

}  // namespace orb360::nn
