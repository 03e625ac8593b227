#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// A tensor as PyTorch computed it, channels x height x width without gaps. Of a large one only the
/// first channels are kept.
struct DumpedTensor {
  Shape shape;
  std::vector<float> values;
};

/// Inputs and results of one run of a network, by name.
using Dump = std::map<std::string, DumpedTensor, std::less<>>;

/// The runs that weights_tools.dump_reference stored with a network, by name;
/// docs/formats/network.md describes the files.
std::map<std::string, Dump> ReadDumps(const std::filesystem::path& path);

}  // namespace orb360::nn
