#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Normalized convolution (Eldesokey, Felsberg, Khan): inputs x and its confidence c, outputs y =
/// sum(w x c) / (sum(w c) + 1e-20) + bias and c' = sum(w c) / sum(w). Weights are >= 0.
struct NormalizedConvolutionOp {
  Padding padding = Padding::kZero;  ///< Values around x and c.
};
/// Takes x and c from the pixel of each 2x2 square with the largest c, then reduces c by `rule`.
struct ConfidencePoolOp {
  /// What the pooled confidence becomes.
  enum class Rule : std::uint8_t {
    kQuarter,               ///< A quarter of c.
    kSqrt,                  ///< The square root of c.
  } rule = Rule::kQuarter;  ///< How the confidence is reduced.
};
/// Convolution with a kernel of size 1, 3 or 5, plus bias.
struct ConvolutionOp {
  int stride = 1;                    ///< 1 or 2; with 2, output (y, x) is centred on (2y, 2x).
  Padding padding = Padding::kZero;  ///< Values around the input.
};
/// Fully connected layer, y = W x + bias, of tensors of 1x1 pixels.
struct DenseOp {};
/// Doubles height and width by repeating pixels.
struct UpsampleNearestOp {};
/// Doubles height and width by bilinear interpolation at (x + 0.5) / 2 - 0.5.
struct UpsampleBilinearOp {
  Padding padding = Padding::kZero;  ///< Values around the input.
};
/// Multiplies height and width of a tensor of one channel by `factor`: each output pixel is a
/// convex combination of 3x3 input pixels, with the softmax of nine of the 9 factor^2 channels of
/// the second input as weights.
struct ConvexUpsampleOp {
  Padding padding = Padding::kZero;  ///< Values around the first input.
  int factor = 2;                    ///< 1 or 2; 1 is a filter whose weights differ at each pixel.
};
/// Halves height and width: the mean of each 2x2 square.
struct AveragePoolOp {};
/// Reduces the image to 1x1: the mean of each channel.
struct GlobalAveragePoolOp {};
/// Computes max(x, 0) of each element.
struct ReluOp {};
/// Computes the hyperbolic tangent of each element.
struct TanhOp {};
/// Computes 1 / (1 + exp(-x)) of each element.
struct SigmoidOp {};
/// Computes ln(1 + exp(x)) of each element.
struct SoftplusOp {};
/// Computes the natural exponential of each element.
struct ExpOp {};
/// Computes the natural logarithm of each element.
struct LogOp {};
/// Computes x of each element where x > 0, and slope * x elsewhere.
struct LeakyReluOp {
  float slope = 0;  ///< Factor of values that are not positive.
};
/// Limits each element to the interval [minimum, maximum].
struct ClampOp {
  float minimum = 0;  ///< Smallest value of the output.
  float maximum = 0;  ///< Largest value of the output.
};
/// Computes scale * x + offset of each element.
struct AffineOp {
  float scale = 1;   ///< Factor of x.
  float offset = 0;  ///< Term that is added to scale * x.
};
/// Adds two tensors of equal shape element by element.
struct AddOp {};
/// Multiplies two tensors of equal shape element by element.
struct MultiplyOp {};
/// Concatenates the channels of its inputs in their order.
struct ConcatenateOp {};
/// Selects channels first to first + count - 1.
struct SliceOp {
  int first = 0;  ///< Index of the first channel, from 0.
  int count = 0;  ///< Number of channels, at least 1.
};
/// Divides sparse depth by its median s and takes logarithms: inputs depth and confidence, outputs
/// x = ln(depth / s), c = min(confidence, 1), both 0 where there is no point, and s of 1x1 pixels.
struct MedianLogOp {};
/// Gives one channel of the input's size that holds the sine of the latitude of each row.
struct LatitudeSineOp {};

/// One of the operations above with its attributes. docs/formats/network.md defines exactly what
/// each computes, and the order of its inputs, outputs and weights.
using Operation = std::variant<NormalizedConvolutionOp, ConfidencePoolOp, ConvolutionOp, DenseOp,
                               UpsampleNearestOp, UpsampleBilinearOp, ConvexUpsampleOp,
                               AveragePoolOp, GlobalAveragePoolOp, ReluOp, TanhOp, SigmoidOp,
                               SoftplusOp, ExpOp, LogOp, LeakyReluOp, ClampOp, AffineOp, AddOp,
                               MultiplyOp, ConcatenateOp, SliceOp, MedianLogOp, LatitudeSineOp>;

/// Returns the name that an operation has in a network file.
const char* NameOf(const Operation& operation);

/// Size of a tensor in relation to the image.
struct Extent {
  bool is_single = false;  ///< Whether the tensor has 1x1 pixels, however large the image is.
  /// Number n of halvings: the size is that of the image divided by 2^n, rounded up. It is negative
  /// where the tensor is larger than the image.
  int halvings = 0;
  /// Compares all members.
  friend bool operator==(const Extent&, const Extent&) = default;
};

/// A tensor between nodes, written by one of them or by the caller.
struct Tensor {
  std::string name;  ///< Name in the network file, unique in the graph.
  int channels = 0;  ///< Number of channels.
  Extent extent;     ///< Height and width in relation to the image.
};

/// Returns the shape of the tensor for an image of `height` x `width` pixels. Halves are rounded
/// up.
Shape ShapeFor(const Tensor& tensor, int height, int width);

/// A trained tensor of weights. Several nodes may use the same one.
struct Weight {
  std::string name;           ///< Name of its dataset below /weights in the network file.
  std::vector<int> shape;     ///< Dimensions; O x I x k x k for a kernel, O for a bias.
  std::vector<float> values;  ///< Elements; the last dimension is contiguous.
};

/// Values that the input of a convolution has, as a calibration found them. Zero lies between.
struct InputRange {
  float minimum = 0;  ///< Smallest value, 0 or less.
  float maximum = 1;  ///< Largest value, above 0.
};

/// One step of a network: an operation with its operands.
struct Node {
  std::string name;          ///< Name in the network file, for messages.
  Operation operation;       ///< What the node computes.
  std::vector<int> inputs;   ///< Indices of the tensors that it reads in Graph::tensors.
  std::vector<int> outputs;  ///< Indices of the tensors that it writes in Graph::tensors.
  /// Indices of `weight` and `bias` in Graph::weights, for operations that have them.
  std::vector<int> weights;
  /// For a convolution that may multiply in 8 bits: the range of its input that is rounded to them.
  std::optional<InputRange> input_range = {};
};

/// A network. The result of ParseGraph satisfies everything that docs/formats/network.md requires:
/// every index, shape, attribute and weight is valid for every image whose size is a multiple of
/// `size_multiple`.
struct Graph {
  /// A tensor that the caller reads after a run.
  struct Output {
    std::string name;  ///< Name of the output, which may differ from that of its tensor.
    int tensor = 0;    ///< Index into Graph::tensors.
  };

  std::string name;             ///< Name of the network, for messages.
  int size_multiple = 1;        ///< Height and width of images are multiples of it.
  std::vector<Tensor> tensors;  ///< All inputs and results of nodes.
  std::vector<int> inputs;      ///< Indices of the tensors that the caller writes.
  std::vector<Node> nodes;      ///< Nodes in the order in which they run.
  std::vector<Output> outputs;  ///< Results of the network.
  std::vector<Weight> weights;  ///< All trained weights.
  /// Text of a JSON object that states how inputs are normalized. DepthCompletion acts on its keys
  /// `width` and `log_error` (docs/formats/network.md).
  std::string normalisation;
  /// Text of a JSON object that states how the network was trained, for people.
  std::string provenance;
};

/// Returns the side of the kernel, pixels, of a node that is a normalized or plain convolution.
int KernelSize(const Graph& graph, const Node& node);

/// Returns the number of values in all weights.
std::int64_t CountParameters(const Graph& graph);

/// Returns the number of multiplications with weights, each added to a sum, that the node's
/// definition needs for an image of that size. A tap of a normalized convolution counts as two.
std::int64_t MultiplyAdds(const Graph& graph, const Node& node, int height, int width);

}  // namespace orb360::nn
