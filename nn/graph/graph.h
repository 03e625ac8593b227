#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "nn/tensor.h"

namespace orb360::nn {

/// The operations, with their attributes. What they compute: docs/networks.md.
struct NormalizedConvolutionOp {
  Padding padding = Padding::kZero;
};
struct ConfidencePoolOp {
  enum class Rule : std::uint8_t { kQuarter, kSqrt } rule = Rule::kQuarter;
};
struct ConvolutionOp {
  int stride = 1;
  Padding padding = Padding::kZero;
};
struct DenseOp {};
struct UpsampleNearestOp {};
struct UpsampleBilinearOp {
  Padding padding = Padding::kZero;
};
struct ConvexUpsampleOp {
  Padding padding = Padding::kZero;
};
struct AveragePoolOp {};
struct GlobalAveragePoolOp {};
struct ReluOp {};
struct TanhOp {};
struct SigmoidOp {};
struct SoftplusOp {};
struct ExpOp {};
struct LogOp {};
struct LeakyReluOp {
  float slope = 0;
};
struct ClampOp {
  float minimum = 0;
  float maximum = 0;
};
struct AffineOp {
  float scale = 1;
  float offset = 0;
};
struct AddOp {};
struct MultiplyOp {};
struct ConcatenateOp {};
struct SliceOp {
  int first = 0;
  int count = 0;
};
struct MedianLogOp {};
struct LatitudeSineOp {};

using Operation = std::variant<NormalizedConvolutionOp, ConfidencePoolOp, ConvolutionOp, DenseOp,
                               UpsampleNearestOp, UpsampleBilinearOp, ConvexUpsampleOp,
                               AveragePoolOp, GlobalAveragePoolOp, ReluOp, TanhOp, SigmoidOp,
                               SoftplusOp, ExpOp, LogOp, LeakyReluOp, ClampOp, AffineOp, AddOp,
                               MultiplyOp, ConcatenateOp, SliceOp, MedianLogOp, LatitudeSineOp>;

/// How the name of an operation is written in a file.
const char* NameOf(const Operation& operation);

/// The size of a tensor for pictures of any size.
struct Extent {
  bool is_single = false;  // one pixel, however large the picture is
  int halvings = 0;        // the picture's size is divided by 2 so often; below 0: multiplied
  friend bool operator==(const Extent&, const Extent&) = default;
};

/// What flows between nodes; written by one of them or by the caller.
struct Tensor {
  std::string name;
  int channels = 0;
  Extent extent;
};

/// The tensor for a picture of that size. Halves are rounded up.
Shape ShapeFor(const Tensor& tensor, int height, int width);

struct Weight {
  std::string name;
  std::vector<int> shape;
  std::vector<float> values;  // the last dimension is contiguous
};

struct Node {
  std::string name;
  Operation operation;
  std::vector<int> inputs;   // indices into Graph::tensors
  std::vector<int> outputs;  // likewise
  /// Indices into Graph::weights: `weight` and `bias` of the operations that have them.
  std::vector<int> weights;
};

/// A network. Whoever holds one that ParseGraph made may rely on everything docs/networks.md asks
/// for: every index, shape, attribute and weight is valid for every picture whose size is a
/// multiple of `size_multiple`.
struct Graph {
  struct Output {
    std::string name;
    int tensor = 0;
  };

  std::string name;
  int size_multiple = 1;
  std::vector<Tensor> tensors;
  std::vector<int> inputs;  // tensors that the caller writes
  std::vector<Node> nodes;  // in the order they run in
  std::vector<Output> outputs;
  std::vector<Weight> weights;
  /// For people: what the network expects and where it comes from. Text of JSON objects.
  std::string normalisation;
  std::string provenance;
};

/// Side of the kernel of a normalized or plain convolution.
int KernelSize(const Graph& graph, const Node& node);

/// Numbers in all weights.
std::int64_t CountParameters(const Graph& graph);

/// Multiplications with weights, each added to something, that the node's definition asks for on a
/// picture of that size; two of them for each tap of a normalized convolution.
std::int64_t MultiplyAdds(const Graph& graph, const Node& node, int height, int width);

}  // namespace orb360::nn
