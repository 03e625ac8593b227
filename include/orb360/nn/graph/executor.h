#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <orb360/nn/base/aligned_vector.h>
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// How an Executor computes.
struct ExecutorOptions {
  /// Number of OpenMP threads of one run, at least 1. No result depends on it.
  int threads = 1;
  /// The type in which convolutions multiply. kBFloat16 is faster and rounds to 8 bits; it needs a
  /// processor that supports it (UserError otherwise). Everything else is computed in floats.
  DataType precision = DataType::kFloat;
  /// Runs every node by itself and keeps its result (Executor::Find). This is for inspection and is
  /// slow.
  bool keeps_tensors = false;
};

/// A network prepared for images of one size: formats chosen, nodes fused, weights packed, memory
/// planned. It does not need the graph any more and never changes, so any number of threads may run
/// it at once, each with a workspace of its own.
class Executor {
 public:
  /// Memory of one run. A workspace serves one run at a time.
  class Workspace {
   public:
    /// Allocates the memory. Throws UserError where there is too little.
    explicit Workspace(const Executor& executor);

   private:
    friend class Executor;
    struct Bound {  // what one instruction works on
      std::vector<TensorView> inputs;
      std::vector<TensorView> outputs;
      std::span<std::byte> scratch;
    };
    AlignedVector<std::byte> memory_;
    std::vector<TensorView> views_;  // by value
    std::vector<Bound> bound_;       // by instruction
  };

  /// An input or output: channels x height x width floats, row by row.
  struct Port {
    std::string name;  ///< Name of the input or output in the graph.
    Shape shape;       ///< Size for the images of this executor.
  };

  /// Prepares the graph for images of `height` x `width` pixels. Throws UserError for an image size
  /// that the graph does not accept.
  Executor(const Graph& graph, int height, int width, const ExecutorOptions& options = {});

  /// Returns the inputs in the order in which Run takes them.
  const std::vector<Port>& inputs() const { return inputs_; }
  /// Returns the outputs in the order in which Run writes them.
  const std::vector<Port>& outputs() const { return outputs_; }

  /// Computes `outputs` from `inputs`, which have the order and sizes of inputs() and outputs().
  /// Nothing is allocated. Throws ContractError for another number of arrays or another size of
  /// one. The bits are the same for any number of threads.
  void Run(std::span<const std::span<const float>> inputs,
           std::span<const std::span<float>> outputs, Workspace* workspace) const;

  /// Returns what the last run in `workspace` wrote to the tensor of that name in the graph.
  /// Contract: keeps_tensors was set and the graph has such a tensor.
  TensorView Find(const Workspace& workspace, std::string_view tensor) const;

  /// Returns the bytes of a workspace, in which tensors share memory.
  std::size_t planned_bytes() const;
  /// Returns the bytes that a workspace would have if every tensor had memory of its own.
  std::size_t naive_bytes() const;

 private:
  struct Plan;  // the instructions and the places of their tensors in memory

  int threads_;
  std::shared_ptr<const Plan> plan_;
  std::vector<Port> inputs_;
  std::vector<Port> outputs_;
  std::vector<std::string> tensors_;  // names of the graph's; only with keeps_tensors
};

}  // namespace orb360::nn
