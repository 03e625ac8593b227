#pragma once

#include <functional>

#include "benchmarks/nn/device_peaks.h"
#include <orb360/nn/graph/executor.h>
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// Prints the least time of each node in `runs` runs, what it computes and moves (LayerCosts) in
/// that time, and how much of `peaks` that is: products of convolutions as those of their
/// definition over the peak of 32-bit floats, and bytes as those of 32-bit floats. Winograd needs
/// fewer products and other types are faster, so that both may be above the peak. \param executor
/// measures times, for images of that height and twice as wide. \param device the one on which it
/// runs. \param run runs it once.
void PrintNodeTimes(const Graph& graph, const Executor& executor, const Device& device, int height,
                    const Executor::Workspace& workspace, int runs, const Peaks& peaks,
                    const std::function<void()>& run);

}  // namespace orb360::nn
