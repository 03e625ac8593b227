#include <algorithm>
#include <utility>

#include "nn/graph/backend.h"
#include "nn/graph/cpu_backend.h"
#include "nn/graph/fusion.h"
#include "nn/graph/limits.h"
#include "nn/graph/lowering.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/executor.h>

namespace orb360::nn {
namespace {

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

std::size_t SizeOf(const Shape& shape) {
  return static_cast<std::size_t>(shape.channels) * Index(shape.height) * Index(shape.width);
}

void CheckImageSize(const Graph& graph, int height, int width) {
  const auto is_allowed = [&](int side) {
    return side > 0 && side <= limits::kMaxImageSide && side % graph.size_multiple == 0;
  };
  if (is_allowed(height) && is_allowed(width)) return;
  throw UserError("network \"" + graph.name + "\" takes images whose sides are multiples of " +
                  std::to_string(graph.size_multiple) + " and at most " +
                  std::to_string(limits::kMaxImageSide) + ", not " + std::to_string(width) + "x" +
                  std::to_string(height));
}

}  // namespace

Executor::Workspace::Workspace(const Executor& executor) : memory_(executor.program_->Allocate()) {}
Executor::Workspace::~Workspace() = default;
Executor::Workspace::Workspace(Workspace&&) noexcept = default;
Executor::Workspace& Executor::Workspace::operator=(Workspace&&) noexcept = default;

Executor::Executor(const Graph& graph, int height, int width, const ExecutorOptions& options) {
  ORB360_CHECK(options.threads >= 1, options.threads);
  ORB360_CHECK(options.device.backend == nullptr || options.precision == DataType::kFloat);
  CheckImageSize(graph, height, width);
  const std::shared_ptr<const Backend> backend =
      options.device.backend != nullptr
          ? options.device.backend
          : std::make_shared<CpuBackend>(options.threads, options.precision);
  const std::vector<FusedNode> nodes =
      options.keeps_tensors ? KeepNodes(graph) : backend->Fuse(graph);
  Lowered lowered = Lower(graph, nodes, *backend, height, width);
  if (options.keeps_tensors) value_of_tensor_ = lowered.value_of_tensor;
  if (options.measures_times) {
    parts_.emplace_back("inputs");
    for (const Instruction& instruction : lowered.instructions) parts_.push_back(instruction.name);
    parts_.emplace_back("outputs");
  }
  program_ = backend->MakeProgram(
      graph, nodes, std::move(lowered), height, width,
      {.keeps_values = options.keeps_tensors, .measures_times = options.measures_times});
  const auto shape = [&](int tensor) {
    return ShapeFor(graph.tensors[Index(tensor)], height, width);
  };
  for (const int tensor : graph.inputs) {
    inputs_.push_back({graph.tensors[Index(tensor)].name, shape(tensor)});
  }
  for (const Graph::Output& output : graph.outputs) {
    outputs_.push_back({output.name, shape(output.tensor)});
  }
  if (!options.keeps_tensors) return;
  for (const Tensor& tensor : graph.tensors) tensors_.push_back(tensor.name);
}

void Executor::Run(std::span<const std::span<const float>> inputs,
                   std::span<const std::span<float>> outputs, Workspace* workspace) const {
  ORB360_CHECK(inputs.size() == inputs_.size(), inputs.size(), inputs_.size());
  ORB360_CHECK(outputs.size() == outputs_.size(), outputs.size(), outputs_.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    ORB360_CHECK(inputs[i].size() == SizeOf(inputs_[i].shape), inputs_[i].name, inputs[i].size());
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    ORB360_CHECK(outputs[i].size() == SizeOf(outputs_[i].shape), outputs_[i].name,
                 outputs[i].size());
  }
  program_->Run(inputs, outputs, workspace->memory_.get());
}

TensorView Executor::Find(const Workspace& workspace, std::string_view tensor) const {
  const auto found = std::ranges::find(tensors_, tensor);
  ORB360_CHECK(found != tensors_.end(), tensor);
  const auto index = static_cast<std::size_t>(found - tensors_.begin());
  return program_->Find(*workspace.memory_, value_of_tensor_[index]);
}

std::vector<Executor::Time> Executor::Times(const Workspace& workspace) const {
  ORB360_CHECK(!parts_.empty(), "times are not measured");
  const std::vector<double> milliseconds = program_->Times(*workspace.memory_);
  std::vector<Time> times;
  for (std::size_t i = 0; i < milliseconds.size(); ++i) {
    times.push_back({parts_[i], milliseconds[i]});
  }
  return times;
}

std::size_t Executor::planned_bytes() const { return program_->planned_bytes(); }

std::size_t Executor::naive_bytes() const { return program_->naive_bytes(); }

}  // namespace orb360::nn
