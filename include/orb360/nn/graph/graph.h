#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// The operations with their attributes. docs/formats/network.md defines what they compute.
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

/// Returns the name of an operation in a file.
const char* NameOf(const Operation& operation);

/// Size of a tensor in relation to the image.
struct Extent {
  bool is_single = false;  // one pixel, however large the image is
  int halvings = 0;        // the image's size is divided by 2 so often; below 0: multiplied
  friend bool operator==(const Extent&, const Extent&) = default;
};

/// A tensor between nodes, written by one of them or by the caller.
struct Tensor {
  std::string name;
  int channels = 0;
  Extent extent;
};

/// Returns the shape of the tensor for an image of that size. Halves are rounded up.
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
  /// Indices into Graph::weights: `weight` and `bias`, for operations that have them.
  std::vector<int> weights;
};

/// A network. The result of ParseGraph satisfies everything that docs/formats/network.md requires:
/// every index, shape, attribute and weight is valid for every image whose size is a multiple of
/// `size_multiple`.
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
  /// Text of JSON objects, for people: what the network expects and where it comes from.
  std::string normalisation;
  std::string provenance;
};

/// Returns the side of the kernel of a normalized or plain convolution.
int KernelSize(const Graph& graph, const Node& node);

/// Returns the number of values in all weights.
std::int64_t CountParameters(const Graph& graph);

/// Returns the number of multiplications with weights, each added to a sum, that the node's
/// definition needs for an image of that size. A tap of a normalized convolution counts as two.
std::int64_t MultiplyAdds(const Graph& graph, const Node& node, int height, int width);

}  // namespace orb360::nn
