#pragma once

#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// A network being written down, as a test needs it. What it makes has the form of a file; whether
/// it is allowed is for ParseGraph to say. Weights are random, the same for the same seed.
class NetworkBuilder {
 public:
  explicit NetworkBuilder(int size_multiple = 1, unsigned seed = 1);

  /// The functions that add something give the name of (the first of) the tensors it writes.
  std::string Input(const std::string& name, int channels);
  /// A node with outputs NAME, NAME.1, ...
  std::string Node(const std::string& name, const std::string& op,
                   const std::vector<std::string>& inputs,
                   const nlohmann::json& attributes = nlohmann::json::object(), int outputs = 1);
  /// Weights NAME.weight (outputs x inputs x kernel x kernel) and NAME.bias: symmetric around zero,
  /// scaled so that values keep their size from layer to layer.
  std::string Convolution(const std::string& name, const std::string& input, int inputs,
                          int outputs, int kernel, int stride = 1,
                          const std::string& padding = "wrap_replicate");
  /// Likewise with positive weights. Gives NAME; the confidence is NAME.1.
  std::string NormalizedConvolution(const std::string& name, const std::string& x,
                                    const std::string& c, int inputs, int outputs, int kernel,
                                    const std::string& padding = "wrap_replicate");
  std::string Dense(const std::string& name, const std::string& input, int inputs, int outputs);
  void Output(const std::string& name, const std::string& tensor);

  void AddWeight(const std::string& name, const std::vector<int>& shape, float low, float high);

  Graph Build() const;
  /// As a file: `is_half` stores the weights in 16 bits.
  void Write(const std::filesystem::path& path, bool is_half = false) const;

  nlohmann::json json;
  std::vector<Weight> weights;

 private:
  std::mt19937 random_;
};

/// Puts the header with the digest before `content`, an HDF5 file with 512 bytes of user block.
void WriteWithHeader(const std::filesystem::path& path, std::string content);

}  // namespace orb360::nn
