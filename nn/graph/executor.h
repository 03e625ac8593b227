#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/aligned_vector.h"
#include "nn/graph/graph.h"
#include "nn/graph/lowering.h"
#include "nn/graph/placement.h"

namespace orb360::nn {

struct ExecutorOptions {
  int threads = 1;
  /// What convolutions multiply: kBFloat16 is faster and rounds to 8 bits, for processors that have
  /// it (UserError for others). Everything else is computed with floats.
  DataType precision = DataType::kFloat;
  /// Runs every node by itself and keeps what each of them writes (Executor::Find): to look inside,
  /// not to be fast.
  bool keeps_tensors = false;
};

/// A network made ready for pictures of one size: formats chosen, nodes fused, weights packed,
/// memory planned. It does not need the graph any more and never changes, so any number of threads
/// may run it at once, each in a workspace of its own.
class Executor {
 public:
  /// The memory of one run at a time.
  class Workspace {
   public:
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

  /// A tensor that goes in or out: channels x height x width floats, row by row.
  struct Port {
    std::string name;
    Shape shape;
  };

  /// Throws UserError for a size of picture that the graph does not take.
  Executor(const Graph& graph, int height, int width, const ExecutorOptions& options = {});

  const std::vector<Port>& inputs() const { return inputs_; }
  const std::vector<Port>& outputs() const { return outputs_; }

  /// Computes `outputs` of `inputs`, both in the order of inputs() and outputs() and of their
  /// sizes. Nothing is allocated. The same bits for any number of threads.
  void Run(std::span<const std::span<const float>> inputs,
           std::span<const std::span<float>> outputs, Workspace* workspace) const;

  /// What the last run in `workspace` has written under that name in the graph. Only with
  /// keeps_tensors.
  TensorView Find(const Workspace& workspace, std::string_view tensor) const;

  /// Bytes of a workspace, and what they would be if every tensor had memory of its own.
  std::size_t planned_bytes() const { return placement_.bytes; }
  std::size_t naive_bytes() const { return placement_.separate_bytes; }

 private:
  int threads_;
  Lowered lowered_;
  Placement placement_;
  std::vector<Port> inputs_;
  std::vector<Port> outputs_;
  std::vector<std::string> tensors_;  // names of the graph's; only with keeps_tensors
};

}  // namespace orb360::nn
