#pragma once

#include <vector>

#include "tests/nn/graph/network_builder.h"
#include "tests/nn/kernels/plain_image.h"

namespace orb360::nn {

/// A network of some `nodes` nodes of every operation, wired at random. All values stay moderate,
/// so that rounding errors do. Inputs: `image` (3 channels), `depth`, `confidence`;
/// size_multiple 8.
NetworkBuilder RandomNetwork(int nodes, unsigned seed);

/// Inputs for it: an image in 0..1 and a sparse depth with its confidence.
std::vector<PlainImage> RandomInputs(int height, int width, unsigned seed);

}  // namespace orb360::nn
