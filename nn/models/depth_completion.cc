#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "nn/models/resample.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/models/depth_completion.h>

namespace orb360::nn {
namespace {

std::size_t PixelsOf(ImageSize size) {
  return static_cast<std::size_t>(size.height) * static_cast<std::size_t>(size.width);
}

/// Returns the nearest size that the network takes, at least one multiple in each direction.
ImageSize NearestMultiple(ImageSize size, int multiple) {
  const auto nearest = [multiple](int side) {
    return std::max((side + multiple / 2) / multiple, 1) * multiple;
  };
  return {nearest(size.height), nearest(size.width)};
}

[[noreturn]] void RefuseNormalisation(const Graph& graph, const std::string& key,
                                      const std::string& expected) {
  throw UserError("network \"" + graph.name + "\": \"" + key +
                  "\" of its normalisation should be " + expected);
}

/// Returns the width of the images that the network expects: `width` of its normalisation, which
/// may be absent.
std::optional<int> ExpectedWidth(const Graph& graph) {
  const nlohmann::json normalisation = nlohmann::json::parse(graph.normalisation);
  if (!normalisation.contains("width")) return {};
  constexpr int kMaxWidth = 1 << 15;  // pixels
  const nlohmann::json& width = normalisation["width"];
  if (!width.is_number_integer() || width < 1 || width > kMaxWidth) {
    RefuseNormalisation(graph, "width", "an integer from 1 to " + std::to_string(kMaxWidth));
  }
  return width.get<int>();
}

/// Returns the confidence for a network whose own confidence states no error: from `log_error` of
/// its normalisation, which may be absent.
std::optional<float> ConstantConfidence(const Graph& graph) {
  const nlohmann::json normalisation = nlohmann::json::parse(graph.normalisation);
  if (!normalisation.contains("log_error")) return {};
  const nlohmann::json& error = normalisation["log_error"];
  if (!error.is_number() || !(error > 0) || error > 10) {
    RefuseNormalisation(graph, "log_error", "a number above 0 and up to 10");
  }
  return 1 / (1 + error.get<float>());
}

/// Returns the size at which the network runs for images of that size.
ImageSize NetworkSize(const Graph& graph, ImageSize size) {
  ORB360_CHECK(size.height > 0 && size.width > 0, size.height, size.width);
  if (const std::optional<int> width = ExpectedWidth(graph)) {
    const double factor = static_cast<double>(*width) / size.width;
    size = {static_cast<int>(std::lround(size.height * factor)), *width};
  }
  return NearestMultiple(size, graph.size_multiple);
}

/// Finds inputs and outputs by name and refuses those of a wrong kind.
struct PortFinder {
  const Graph& graph;

  [[noreturn]] void Refuse(const std::string& reason) const {
    throw UserError("network \"" + graph.name + "\" is not for depth completion: " + reason);
  }
  void Check(const char* kind, const std::string& name, const Tensor& tensor, int channels,
             bool is_single) const {
    const bool fits =
        tensor.channels == channels && tensor.extent == Extent{.is_single = is_single};
    if (fits) return;
    Refuse(std::string(kind) + " \"" + name + "\" should have " + std::to_string(channels) +
           (channels == 1 ? " channel" : " channels") +
           (is_single ? " of 1x1" : " of the image's size"));
  }
  std::optional<std::size_t> Input(const std::string& name, int channels) const {
    for (std::size_t i = 0; i < graph.inputs.size(); ++i) {
      const Tensor& tensor = graph.tensors[static_cast<std::size_t>(graph.inputs[i])];
      if (tensor.name != name) continue;
      Check("input", name, tensor, channels, /*is_single=*/false);
      return i;
    }
    return {};
  }
  std::optional<std::size_t> Output(const std::string& name, bool is_single) const {
    for (std::size_t i = 0; i < graph.outputs.size(); ++i) {
      if (graph.outputs[i].name != name) continue;
      Check("output", name, graph.tensors[static_cast<std::size_t>(graph.outputs[i].tensor)], 1,
            is_single);
      return i;
    }
    return {};
  }
  std::size_t Required(const char* kind, const char* name, std::optional<std::size_t> port) const {
    if (!port) Refuse(std::string("it has no ") + kind + " \"" + name + "\"");
    return *port;
  }
};

}  // namespace

DepthCompletion::Ports DepthCompletion::FindPorts(const Graph& graph) {
  const PortFinder find{graph};
  Ports ports;
  ports.image = find.Input("image", 3);
  ports.sparse_depth = find.Required("input", "depth", find.Input("depth", 1));
  ports.sparse_confidence = find.Required("input", "confidence", find.Input("confidence", 1));
  for (const int input : graph.inputs) {
    const std::string& name = graph.tensors[static_cast<std::size_t>(input)].name;
    if (name != "image" && name != "depth" && name != "confidence") {
      find.Refuse("nothing is known of its input \"" + name + "\"");
    }
  }
  const std::optional<std::size_t> depth = find.Output("depth", /*is_single=*/false);
  if (!depth) ports.log_depth = find.Output("log_depth", /*is_single=*/false);
  ports.depth = find.Required("output", "depth", depth ? depth : ports.log_depth);
  ports.confidence =
      find.Required("output", "confidence", find.Output("confidence", /*is_single=*/false));
  ports.ground = find.Output("ground", /*is_single=*/false);
  if (ports.log_depth) {
    ports.scale = find.Required("output", "scale", find.Output("scale", /*is_single=*/true));
    ports.log_metric_scale = find.Output("log_metric_scale", /*is_single=*/true);
  }
  return ports;
}

DepthCompletion::DepthCompletion(const Graph& graph, ImageSize size, const ExecutorOptions& options)
    : size_(size),
      network_size_(NetworkSize(graph, size)),
      constant_confidence_(ConstantConfidence(graph)),
      ports_(FindPorts(graph)),
      executor_(graph, network_size_.height, network_size_.width, options) {}

DepthCompletion::Workspace::Workspace(const DepthCompletion& model) : network_(model.executor_) {
  const auto allocate = [](const std::vector<Executor::Port>& ports) {
    std::vector<std::vector<float>> values;
    for (const Executor::Port& port : ports) {
      const ImageSize size{port.shape.height, port.shape.width};
      values.emplace_back(static_cast<std::size_t>(port.shape.channels) * PixelsOf(size));
    }
    return values;
  };
  inputs_ = allocate(model.executor_.inputs());
  outputs_ = allocate(model.executor_.outputs());
}

void DepthCompletion::FillImage(std::span<const std::uint8_t> rgb, std::span<float> planes) const {
  const std::size_t pixels = PixelsOf(size_);
  const std::size_t network_pixels = PixelsOf(network_size_);
  constexpr float kWhite = 255;
  std::vector<float> plane(pixels);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    for (std::size_t i = 0; i < pixels; ++i) {
      plane[i] = static_cast<float>(rgb[3 * i + channel]) / kWhite;
    }
    const std::span<float> to = planes.subspan(channel * network_pixels, network_pixels);
    if (size_ == network_size_) {
      std::ranges::copy(plane, to.begin());
    } else {
      ResampleImage(plane, size_, to, network_size_);
    }
  }
}

void DepthCompletion::FillPoints(const CompletionInput& image, std::span<float> depth,
                                 std::span<float> confidence) const {
  std::vector<float> known_depth(PixelsOf(size_));
  std::vector<float> known_confidence(known_depth.size());
  for (std::size_t i = 0; i < known_depth.size(); ++i) {
    const bool is_point =
        std::isfinite(image.depth[i]) && image.depth[i] > 0 && image.confidence[i] > 0;
    if (!is_point) continue;
    known_depth[i] = image.depth[i];
    known_confidence[i] = std::min(image.confidence[i], 1.0f);
  }
  ResamplePoints(known_depth, known_confidence, size_, depth, confidence, network_size_);
}

std::vector<float> DepthCompletion::Resampled(std::vector<float> dense) const {
  if (size_ == network_size_) return dense;
  std::vector<float> resampled(PixelsOf(size_));
  ResampleBilinear(dense, network_size_, resampled, size_);
  return resampled;
}

CompletionOutput DepthCompletion::Complete(const CompletionInput& image,
                                           Workspace* workspace) const {
  const std::size_t pixels = PixelsOf(size_);
  ORB360_CHECK(image.rgb.size() == 3 * pixels, image.rgb.size(), pixels);
  ORB360_CHECK(image.depth.size() == pixels, image.depth.size(), pixels);
  ORB360_CHECK(image.confidence.size() == pixels, image.confidence.size(), pixels);
  if (ports_.image) FillImage(image.rgb, workspace->inputs_[*ports_.image]);
  FillPoints(image, workspace->inputs_[ports_.sparse_depth],
             workspace->inputs_[ports_.sparse_confidence]);
  const std::vector<std::span<const float>> inputs(workspace->inputs_.begin(),
                                                   workspace->inputs_.end());
  const std::vector<std::span<float>> outputs(workspace->outputs_.begin(),
                                              workspace->outputs_.end());
  executor_.Run(inputs, outputs, &workspace->network_);

  const std::vector<std::vector<float>>& result = workspace->outputs_;
  CompletionOutput dense;
  dense.confidence = Resampled(result[ports_.confidence]);
  if (ports_.ground) dense.ground = Resampled(result[*ports_.ground]);
  dense.depth = result[ports_.depth];
  if (ports_.log_depth) {
    dense.scale = result[*ports_.scale].front();
    for (float& depth : dense.depth) depth = dense.scale * std::exp(depth);
    if (ports_.log_metric_scale) {
      dense.log_metric_scale = result[*ports_.log_metric_scale].front();
    }
  }
  dense.depth = Resampled(std::move(dense.depth));
  for (std::size_t i = 0; i < pixels; ++i) {
    float& depth = dense.depth[i];
    if (!(std::isfinite(depth) && depth > 0)) depth = 0;
    if (constant_confidence_) dense.confidence[i] = depth > 0 ? *constant_confidence_ : 0;
  }
  return dense;
}

}  // namespace orb360::nn
