#pragma once

#include <filesystem>
#include <string>

#include "tests/nn/dump.h"
#include <orb360/nn/graph/executor.h>
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// Networks of tests/nn/data with what PyTorch computed: of a few nodes, and whole ones.
inline constexpr const char* kReferenceOperations[] = {"convolution",
                                                       "convolution_across_poles",
                                                       "normalized_convolution",
                                                       "normalized_convolution_across_poles",
                                                       "pooling",
                                                       "upsampling",
                                                       "upsampling_across_poles",
                                                       "elementwise",
                                                       "panorama"};
inline constexpr const char* kReferenceNetworks[] = {"unguided", "encoder_decoder", "multi_stream",
                                                     "depth_completion"};
std::filesystem::path ReferenceFile(const std::string& name);

/// Sums of up to 450 products, each rounded: sqrt(450) if all were of the norm's size.
inline constexpr float kRoundingsOfOperation = 20;
/// Errors that add up over some fifty nodes.
inline constexpr float kRoundingsOfNetwork = 64;

/// The worst element of `result` when it is farther than `tolerance` from `expected`, which may
/// hold fewer channels; "" otherwise. NaN and infinity must be where they are expected.
std::string WorstDifference(const DumpedTensor& result, const DumpedTensor& expected,
                            float tolerance);

/// Every tensor of the dumps in a file against those of runs that keep them. `roundings`: how often
/// a value of the size of the norm may have been rounded.
void ExpectEveryTensorOf(const std::filesystem::path& path, float roundings,
                         ExecutorOptions options);

/// The same for outputs of runs as fast as they can be.
void ExpectOutputsOf(const std::filesystem::path& path, float roundings,
                     const ExecutorOptions& options = {});

}  // namespace orb360::nn
