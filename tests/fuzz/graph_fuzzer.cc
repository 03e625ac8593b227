// libFuzzer's target for what reads a network behind the digest: ParseGraph must refuse with a
// UserError or give a graph that can be planned; nothing else, whatever the bytes.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include "nn/graph/buffer_assignment.h"
#include "nn/graph/cpu_needs.h"
#include "nn/graph/fusion.h"
#include "nn/graph/lowering.h"
#include "nn/graph/parse_graph.h"
#include "tests/fuzz/graph_input.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

/// Plans as for the CPU, without kernels.
class NoKernels : public Backend {
 public:
  explicit NoKernels(DataType precision) : precision_(precision) {}
  NodeNeeds NeedsOf(const Graph& graph, const FusedNode& node) const override {
    return CpuNeedsOf(graph, node, precision_);
  }
  std::unique_ptr<const Program> MakeProgram(const Graph&, std::span<const FusedNode>, Lowered, int,
                                             int, const ProgramOptions&) const override {
    return nullptr;
  }

 private:
  DataType precision_;
};

/// Pieces of memory that are needed at the same time must not overlap.
void CheckPlan(const BufferAssignment& assignment) {
  for (std::size_t i = 0; i < assignment.pieces.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Lifetime& a = assignment.pieces[i];
      const Lifetime& b = assignment.pieces[j];
      const bool meet = a.first <= b.last && b.first <= a.last;
      const bool overlap = assignment.offsets[i] < assignment.offsets[j] + b.bytes &&
                           assignment.offsets[j] < assignment.offsets[i] + a.bytes;
      if (meet && overlap) std::abort();
    }
  }
}

void Check(std::string_view text) {
  std::optional<GraphInput> input = ReadGraphInput(text);
  if (!input) return;
  try {
    const Graph graph = ParseGraph(input->json, std::move(input->weights));
    const int side = graph.size_multiple;
    for (const bool fuses : {true, false}) {
      for (const DataType precision : {DataType::kFloat, DataType::kBFloat16}) {
        const Lowered lowered = Lower(graph, fuses ? FuseNodes(graph) : KeepNodes(graph),
                                      NoKernels(precision), side, 2 * side);
        const std::vector<std::size_t> scratch(lowered.instructions.size());
        CheckPlan(AssignBuffers(lowered, scratch, /*keeps_values=*/!fuses));
      }
    }
  } catch (const UserError&) {
    // The refusal of what is not allowed.
  }
}

}  // namespace
}  // namespace orb360::nn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  orb360::nn::Check({reinterpret_cast<const char*>(data), size});
  return 0;
}
