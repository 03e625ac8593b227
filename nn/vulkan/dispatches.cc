#include "nn/vulkan/dispatches.h"

#include <bit>
#include <initializer_list>
#include <utility>
#include <variant>

#include "nn/vulkan/tiles.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn::vulkan {
namespace {

/// FUNCTION of shaders/elementwise.comp.
enum class ElementFunction : std::uint8_t {
  kCopy,
  kLeakyRelu,
  kTanh,
  kSigmoid,
  kSoftplus,
  kExp,
  kLog,
  kClamp,
  kAffine,
};

// What shaders/median.glsl lays out.
constexpr std::uint32_t kMedianWords = 3 * 2048 + 2;

std::uint32_t Word(int value) { return static_cast<std::uint32_t>(value); }
std::uint32_t Word(float value) { return std::bit_cast<std::uint32_t>(value); }

/// Push constants in the order of a shader's block.
class Parameters {
 public:
  Parameters& operator<<(const Place& place) { return Add({place.offset, place.row, place.plane}); }
  Parameters& operator<<(std::uint32_t word) { return Add({word}); }
  Parameters& operator<<(int value) { return Add({Word(value)}); }
  Parameters& operator<<(float value) { return Add({Word(value)}); }
  std::vector<std::uint32_t> Take() { return std::move(words_); }

 private:
  Parameters& Add(std::initializer_list<std::uint32_t> words) {
    words_.insert(words_.end(), words);
    return *this;
  }
  std::vector<std::uint32_t> words_;
};

/// Adds to a launch which of its tensors are 16-bit floats, in the order of the shader's constants.
Dispatch WithStorage(Dispatch dispatch, std::initializer_list<const Place*> places) {
  bool has_halves = false;
  for (const Place* place : places) {
    dispatch.pipeline.constants.push_back(place->is_half ? 1 : 0);
    has_halves |= place->is_half;
  }
  if (has_halves) dispatch.pipeline.shader = WithHalves(dispatch.pipeline.shader);
  return dispatch;
}

/// `constants` begin with width and height of a workgroup.
Dispatch Launch(Shader shader, std::vector<std::uint32_t> constants, Parameters parameters,
                int groups_x, int groups_y, int groups_z) {
  Dispatch dispatch;
  dispatch.pipeline.shader = shader;
  dispatch.pipeline.constants = std::move(constants);
  dispatch.parameters = parameters.Take();
  dispatch.groups = {Word(groups_x), Word(groups_y), Word(groups_z)};
  return dispatch;
}

/// A launch of a shader in which each invocation has a pixel of a channel of `pixels`. `constants`
/// are those behind the size of a workgroup.
Dispatch ForEachPixel(Shader shader, std::initializer_list<std::uint32_t> constants,
                      const Shape& pixels, Parameters parameters) {
  std::vector<std::uint32_t> all = {Word(kGroupWidth), Word(kGroupHeight)};
  all.insert(all.end(), constants);
  return Launch(shader, std::move(all), std::move(parameters), GroupsFor(pixels.width, kGroupWidth),
                GroupsFor(pixels.height, kGroupHeight), pixels.channels);
}

class DispatchMaker {
 public:
  using Result = std::vector<Dispatch>;

  DispatchMaker(const Graph& graph, const FusedNode& fused, const Operands& operands,
                VulkanDevice::Type device, Constants* constants)
      : graph_(graph),
        fused_(fused),
        in_(operands.inputs),
        out_(operands.outputs),
        scratch_(operands.scratch),
        device_(device),
        constants_(constants) {}

  Result operator()(const NormalizedConvolutionOp& op) const {
    const std::uint32_t at = constants_->AddNormalizedConvolution(weight(0), weight(1));
    const auto [channels, height, width] = in_[0].shape;
    Shape groups = out_[0].shape;
    groups.channels = GroupsFor(groups.channels, 4);
    return One(ForEachPixel(Shader::kNormalizedConvolution, {Word(op.padding), Word(kernel())},
                            groups,
                            Parameters() << in_[0] << in_[1] << out_[0] << out_[1] << channels
                                         << height << width << out_[0].shape.channels << at));
  }
  Result operator()(const ConfidencePoolOp& op) const {
    const bool is_quarter = op.rule == ConfidencePoolOp::Rule::kQuarter;
    return One(
        ForEachPixel(Shader::kConfidencePool, {Word(static_cast<int>(is_quarter))}, out_[0].shape,
                     Sized(Parameters() << in_[0] << in_[1] << out_[0] << out_[1], out_[0])));
  }
  Result operator()(const ConvolutionOp& op) const {
    const Shape& from = in_[0].shape;
    const Shape& to = out_[0].shape;
    const ConvolutionTile tile = ChooseTile(device_, kernel(), op.stride, from.channels, to);
    const std::uint32_t at = constants_->AddConvolution(weight(0), weight(1), tile.vectors);
    const bool adds = fused_.adds_residual;
    Parameters parameters;
    const Place& residual = adds ? in_[1] : in_[0];
    parameters << in_[0] << residual << out_[0];
    parameters << from.channels << from.height << from.width;
    parameters << to.channels << to.height << to.width << at << fused_.slope;
    return One(WithStorage(
        Launch(Shader::kConvolution,
               {Word(tile.width), Word(tile.height), Word(op.padding), Word(kernel()),
                Word(op.stride), Word(tile.columns), Word(tile.vectors), Word(tile.chunk),
                Word(static_cast<int>(adds))},
               parameters, GroupsFor(to.width, tile.width * tile.columns),
               GroupsFor(to.height, tile.height), GroupsFor(to.channels, 4 * tile.vectors)),
        {&in_[0], &residual, &out_[0]}));
  }
  Result operator()(const DenseOp&) const {
    const std::uint32_t at = constants_->AddDense(weight(0), weight(1));
    const int outputs = out_[0].shape.channels;
    const int group = 64;  // invocations, one for each output
    return One(Launch(Shader::kDense, {Word(group), 1},
                      Parameters() << in_[0] << out_[0] << in_[0].shape.channels << outputs << at,
                      GroupsFor(outputs, group), 1, 1));
  }
  Result operator()(const UpsampleNearestOp&) const {
    return One(
        WithStorage(ForEachPixel(Shader::kUpsampleNearest, {}, out_[0].shape, FromTo(out_[0])),
                    {&in_[0], &out_[0]}));
  }
  Result operator()(const UpsampleBilinearOp& op) const {
    return One(WithStorage(
        ForEachPixel(Shader::kUpsampleBilinear, {Word(op.padding)}, out_[0].shape, FromTo(in_[0])),
        {&in_[0], &out_[0]}));
  }
  Result operator()(const ConvexUpsampleOp& op) const {
    return One(ForEachPixel(Shader::kConvexUpsample, {Word(op.padding), Word(op.factor)},
                            in_[0].shape,
                            Sized(Parameters() << in_[0] << in_[1] << out_[0], in_[0])));
  }
  Result operator()(const AveragePoolOp&) const {
    return One(WithStorage(ForEachPixel(Shader::kAveragePool, {}, out_[0].shape, FromTo(out_[0])),
                           {&in_[0], &out_[0]}));
  }
  Result operator()(const GlobalAveragePoolOp&) const {
    return One(Launch(Shader::kGlobalAveragePool, {Word(kMaxInvocations), 1}, FromTo(in_[0]), 1, 1,
                      in_[0].shape.channels));
  }
  Result operator()(const ReluOp&) const { return Elementwise(ElementFunction::kLeakyRelu); }
  Result operator()(const TanhOp&) const { return Elementwise(ElementFunction::kTanh); }
  Result operator()(const SigmoidOp&) const { return Elementwise(ElementFunction::kSigmoid); }
  Result operator()(const SoftplusOp&) const { return Elementwise(ElementFunction::kSoftplus); }
  Result operator()(const ExpOp&) const { return Elementwise(ElementFunction::kExp); }
  Result operator()(const LogOp&) const { return Elementwise(ElementFunction::kLog); }
  Result operator()(const LeakyReluOp& op) const {
    return Elementwise(ElementFunction::kLeakyRelu, op.slope);
  }
  Result operator()(const ClampOp& op) const {
    return Elementwise(ElementFunction::kClamp, op.minimum, op.maximum);
  }
  Result operator()(const AffineOp& op) const {
    return Elementwise(ElementFunction::kAffine, op.scale, op.offset);
  }
  Result operator()(const AddOp&) const { return Pair(/*multiplies=*/0); }
  Result operator()(const MultiplyOp&) const { return Pair(/*multiplies=*/1); }
  Result operator()(const MedianLogOp&) const {
    const Place& x = out_[0];
    Result result =
        One(ForEachPixel(Shader::kMedianSelect, {}, x.shape,
                         Sized(Parameters() << in_[0] << in_[1] << x << out_[1], x) << scratch_));
    int shift = 32;
    int pass = 0;
    for (const int bits : {11, 11, 10}) {
      shift -= bits;
      result.push_back(
          ForEachPixel(Shader::kMedianCount, {}, x.shape,
                       Sized(Parameters() << x, x) << scratch_ << pass << shift << bits));
      result.push_back(Launch(Shader::kMedianChoose, {Word(kMaxInvocations), 1},
                              Parameters() << scratch_ << pass << bits, 1, 1, 1));
      ++pass;
    }
    result.push_back(ForEachPixel(Shader::kMedianLog, {}, x.shape,
                                  Sized(Parameters() << x << out_[2], x) << scratch_));
    return result;
  }
  Result operator()(const LatitudeSineOp&) const {
    const std::uint32_t at = constants_->AddLatitudeSines(out_[0].shape.height);
    return One(ForEachPixel(Shader::kLatitudeSine, {}, out_[0].shape,
                            Sized(Parameters() << out_[0], out_[0]) << at));
  }
  Result operator()(const ConcatenateOp&) const { return NotHere(); }
  Result operator()(const SliceOp&) const { return NotHere(); }

 private:
  const Weight& weight(std::size_t i) const {
    return graph_.weights[static_cast<std::size_t>(fused_.node.weights[i])];
  }
  int kernel() const { return KernelSize(graph_, fused_.node); }
  static std::uint32_t Word(int value) { return vulkan::Word(value); }
  static std::uint32_t Word(Padding padding) { return vulkan::Word(static_cast<int>(padding)); }

  static Result One(Dispatch dispatch) {
    Result result;
    result.push_back(std::move(dispatch));
    return result;
  }
  static Parameters Sized(Parameters parameters, const Place& size) {
    parameters << size.shape.height << size.shape.width;
    return parameters;
  }
  Parameters FromTo(const Place& size) const {
    return Sized(Parameters() << in_[0] << out_[0], size);
  }
  Result Elementwise(ElementFunction function, float a = 0, float b = 0) const {
    return One(WithStorage(ForEachPixel(Shader::kElementwise, {Word(static_cast<int>(function))},
                                        out_[0].shape, FromTo(out_[0]) << a << b),
                           {&in_[0], &out_[0]}));
  }
  Result Pair(int multiplies) const {
    return One(
        WithStorage(ForEachPixel(Shader::kElementwisePair, {Word(multiplies)}, out_[0].shape,
                                 Sized(Parameters() << in_[0] << in_[1] << out_[0], out_[0])),
                    {&in_[0], &in_[1], &out_[0]}));
  }
  static Result NotHere() {
    ORB360_CHECK(false, "concatenations and slices are views and copies");
    return {};
  }

  const Graph& graph_;
  const FusedNode& fused_;
  const std::vector<Place>& in_;
  const std::vector<Place>& out_;
  const std::uint32_t scratch_;
  const VulkanDevice::Type device_;
  Constants* const constants_;
};

}  // namespace

std::size_t ScratchBytes(const Operation& operation) {
  return std::holds_alternative<MedianLogOp>(operation) ? kMedianWords * sizeof(std::uint32_t) : 0;
}

bool CanUseHalves(const Operation& operation) {
  return std::holds_alternative<ConvolutionOp>(operation) ||
         std::holds_alternative<AddOp>(operation) || std::holds_alternative<ReluOp>(operation) ||
         std::holds_alternative<LeakyReluOp>(operation) ||
         std::holds_alternative<AveragePoolOp>(operation) ||
         std::holds_alternative<UpsampleNearestOp>(operation) ||
         std::holds_alternative<UpsampleBilinearOp>(operation);
}

std::vector<Dispatch> DispatchesOf(const Graph& graph, const FusedNode& node,
                                   const Operands& operands, VulkanDevice::Type device,
                                   Constants* constants) {
  return std::visit(DispatchMaker(graph, node, operands, device, constants), node.node.operation);
}

Dispatch CopyOf(const Place& from, const Place& to) {
  Parameters parameters;
  parameters << from << to << to.shape.height << to.shape.width << 0.0f << 0.0f;
  return WithStorage(
      ForEachPixel(Shader::kElementwise, {Word(static_cast<int>(ElementFunction::kCopy))}, to.shape,
                   parameters),
      {&from, &to});
}

}  // namespace orb360::nn::vulkan
