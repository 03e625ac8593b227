#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "nn/graph/buffer_assignment.h"
#include "nn/graph/cpu_backend.h"
#include "nn/graph/fusion.h"
#include "nn/graph/limits.h"
#include "nn/graph/lowering.h"
#include "nn/kernels/copy_channels.h"
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

/// Views contiguous floats as a tensor. The view of an input is never written.
TensorView DenseView(const float* data, const Shape& shape) {
  return {const_cast<float*>(data),  // NOLINT: as above
          shape,
          Layout::kPlanar,
          DataType::kFloat,
          0,
          shape.width,
          std::ptrdiff_t{shape.width} * shape.height};
}

}  // namespace

struct Executor::Plan {
  Lowered lowered;
  BufferAssignment assignment;
};

Executor::Workspace::Workspace(const Executor& executor) {
  const BufferAssignment& assignment = executor.plan_->assignment;
  try {
    memory_.resize(assignment.bytes);
  } catch (const std::bad_alloc&) {
    throw UserError("a network needs " + std::to_string(assignment.bytes >> 20) +
                    " MiB of memory for an image of this size, and there is less; use a smaller "
                    "image");
  }
  const Lowered& lowered = executor.plan_->lowered;
  for (std::size_t i = 0; i < lowered.values.size(); ++i) {
    views_.push_back(
        ViewOf(assignment.buffers[i], lowered.values[i].format.shape.channels, memory_.data()));
  }
  const auto views = [&](const std::vector<int>& values) {
    std::vector<TensorView> list;
    list.reserve(values.size());
    for (const int value : values) list.push_back(views_[Index(value)]);
    return list;
  };
  const std::span<std::byte> memory(memory_);
  for (std::size_t i = 0; i < lowered.instructions.size(); ++i) {
    const Instruction& instruction = lowered.instructions[i];
    bound_.push_back({views(instruction.inputs), views(instruction.outputs),
                      memory.subspan(assignment.scratch[i], instruction.step.scratch_bytes)});
  }
}

Executor::Executor(const Graph& graph, int height, int width, const ExecutorOptions& options) {
  ORB360_CHECK(options.threads >= 1, options.threads);
  threads_ = options.threads;
  CheckImageSize(graph, height, width);
  const CpuBackend backend(options.threads, options.precision);
  Plan plan;
  plan.lowered = Lower(graph, options.keeps_tensors ? KeepNodes(graph) : FuseNodes(graph), backend,
                       height, width);
  plan.assignment = AssignBuffers(plan.lowered, options.keeps_tensors);
  plan_ = std::make_shared<const Plan>(std::move(plan));
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
  const Lowered& lowered = plan_->lowered;
  ORB360_CHECK(workspace->bound_.size() == lowered.instructions.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const Shape& shape = inputs_[i].shape;
    ORB360_CHECK(inputs[i].size() == SizeOf(shape), inputs_[i].name, inputs[i].size());
    CopyChannels(DenseView(inputs[i].data(), shape), 0, workspace->views_[Index(lowered.inputs[i])],
                 0, shape.channels, threads_);
  }
  for (std::size_t i = 0; i < lowered.instructions.size(); ++i) {
    const auto& [in, out, scratch] = workspace->bound_[i];
    lowered.instructions[i].step.run(in, out, scratch);
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const Shape& shape = outputs_[i].shape;
    ORB360_CHECK(outputs[i].size() == SizeOf(shape), outputs_[i].name, outputs[i].size());
    CopyChannels(workspace->views_[Index(lowered.outputs[i])], 0,
                 DenseView(outputs[i].data(), shape), 0, shape.channels, threads_);
  }
}

TensorView Executor::Find(const Workspace& workspace, std::string_view tensor) const {
  const auto found = std::ranges::find(tensors_, tensor);
  ORB360_CHECK(found != tensors_.end(), tensor);
  const auto index = static_cast<std::size_t>(found - tensors_.begin());
  return workspace.views_[Index(plan_->lowered.value_of_tensor[index])];
}

std::size_t Executor::planned_bytes() const { return plan_->assignment.bytes; }

std::size_t Executor::naive_bytes() const { return plan_->assignment.separate_bytes; }

}  // namespace orb360::nn
