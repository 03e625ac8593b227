#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <orb360/nn/graph/device.h>
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// A network prepared for a processor, and what one of its runs works in.
class Program;
class ProgramMemory;

/// How an Executor computes.
struct ExecutorOptions {
  /// Number of OpenMP threads of one run, at least 1. No result depends on it.
  int threads = 1;
  /// The type in which convolutions multiply (ChoosePrecision). kBFloat16 rounds to 8 digits; kInt8
  /// rounds to 8 bits where the graph has a range of the input. Both are faster where the processor
  /// supports them (UserError elsewhere). Everything else is computed in floats.
  DataType precision = DataType::kFloat;
  /// The processor that computes. On another one than the CPU, `threads` has no meaning and
  /// `precision` must be kFloat.
  Device device = {};
  /// Runs every node by itself and keeps its result (Executor::Find). This is for inspection and is
  /// slow.
  bool keeps_tensors = false;
  /// Measures how long each node takes (Executor::Times). The constructor throws DeviceError where
  /// a device cannot.
  bool measures_times = false;
};

/// A network prepared for images of one size: formats chosen, nodes fused, weights packed, memory
/// planned. It does not need the graph any more and never changes, so any number of threads may run
/// it at once, each with a workspace of its own.
class Executor {
 public:
  /// Memory of one run. A workspace serves one run at a time.
  class Workspace {
   public:
    /// Allocates the memory. Throws UserError where there is too little, and DeviceError where a
    /// device has too little or fails. A workspace may outlive its executor.
    explicit Workspace(const Executor& executor);
    ~Workspace();
    /// Moves the memory.
    Workspace(Workspace&& other) noexcept;
    /// Frees the memory of this workspace and takes over the other one's.
    Workspace& operator=(Workspace&& other) noexcept;

   private:
    friend class Executor;
    std::unique_ptr<ProgramMemory> memory_;
  };

  /// An input or output: channels x height x width floats, row by row.
  struct Port {
    std::string name;  ///< Name of the input or output in the graph.
    Shape shape;       ///< Size for the images of this executor.
  };

  /// Prepares the graph for images of `height` x `width` pixels. Throws UserError for an image size
  /// that the graph does not accept, and DeviceError where a device has too little memory or fails.
  Executor(const Graph& graph, int height, int width, const ExecutorOptions& options = {});

  /// Returns the inputs in the order in which Run takes them.
  const std::vector<Port>& inputs() const { return inputs_; }
  /// Returns the outputs in the order in which Run writes them.
  const std::vector<Port>& outputs() const { return outputs_; }

  /// Computes `outputs` from `inputs`, which have the order and sizes of inputs() and outputs().
  /// Nothing is allocated. Throws ContractError for another number of arrays, another size of one
  /// or a workspace of another executor, and DeviceError where a device fails; the contents of
  /// `outputs` are undefined then. The bits are the same for any number of threads.
  void Run(std::span<const std::span<const float>> inputs,
           std::span<const std::span<float>> outputs, Workspace* workspace) const;

  /// Returns what the last run in `workspace` wrote to the tensor of that name in the graph.
  /// Contract: keeps_tensors was set and the graph has such a tensor.
  TensorView Find(const Workspace& workspace, std::string_view tensor) const;

  /// How long a part of a run took.
  struct Time {
    std::string name;     ///< Of the node, of the tensor that was copied, or "inputs" or "outputs".
    double milliseconds;  ///< Of the processor that computed it.
  };
  /// Returns the times of the last run in `workspace`, in order: of the copies of inputs, of nodes
  /// and copies between them, and of the copies of outputs. A node stands for those that were
  /// merged with it. On a graphics processor they are the device's own. Empty before the first run.
  /// Throws ContractError for a workspace of another executor, and DeviceError where a device
  /// fails. Contract: measures_times was set.
  std::vector<Time> Times(const Workspace& workspace) const;

  /// Returns the bytes of a workspace, in which tensors share memory.
  std::size_t planned_bytes() const;
  /// Returns the bytes that a workspace would have if every tensor had memory of its own.
  std::size_t naive_bytes() const;

 private:
  std::shared_ptr<const Program> program_;
  std::vector<Port> inputs_;
  std::vector<Port> outputs_;
  std::vector<std::string> tensors_;  // names of the graph's; only with keeps_tensors
  std::vector<int> value_of_tensor_;  // of the program; likewise
  std::vector<std::string> parts_;    // of a run; only with measures_times
};

}  // namespace orb360::nn
