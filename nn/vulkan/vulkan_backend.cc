#include "nn/vulkan/vulkan_backend.h"

#include <type_traits>
#include <utility>
#include <variant>

#include "nn/vulkan/half_storage.h"
#include "nn/vulkan/vulkan_program.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn::vulkan {

VulkanBackend::VulkanBackend(std::shared_ptr<const LogicalDevice> device,
                             VulkanBackendOptions options)
    : device_(std::move(device)),
      pipelines_(std::make_shared<Pipelines>(device_)),
      options_(options) {
  ORB360_CHECK(!options.uses_halves || device_->description().has_float16);
}

NodeNeeds VulkanBackend::NeedsOf(const Graph&, const FusedNode& node) const {
  constexpr PortNeeds kPlanar{.layouts = PortNeeds::Layouts::kPlanar};
  NodeNeeds needs{std::vector(node.node.inputs.size(), kPlanar),
                  std::vector(node.node.outputs.size(), kPlanar),
                  {}};
  // Where an invocation reads only the elements that it writes, the result may replace the input.
  needs.replaceable = std::visit(
      [&]<typename Op>(const Op&) -> std::vector<int> {
        if constexpr (std::is_same_v<Op, AddOp> || std::is_same_v<Op, MultiplyOp>) return {0, 1};
        if constexpr (std::is_same_v<Op, ReluOp> || std::is_same_v<Op, LeakyReluOp> ||
                      std::is_same_v<Op, TanhOp> || std::is_same_v<Op, SigmoidOp> ||
                      std::is_same_v<Op, SoftplusOp> || std::is_same_v<Op, ExpOp> ||
                      std::is_same_v<Op, LogOp> || std::is_same_v<Op, ClampOp> ||
                      std::is_same_v<Op, AffineOp>) {
          return {0};
        }
        if (node.adds_residual) return {1};
        return {};
      },
      node.node.operation);
  return needs;
}

std::unique_ptr<const Program> VulkanBackend::MakeProgram(const Graph& graph,
                                                          std::span<const FusedNode> nodes,
                                                          Lowered lowered, int /*height*/,
                                                          int /*width*/,
                                                          const ProgramOptions& options) const {
  // Whoever looks at tensors looks at 32-bit floats.
  if (options_.uses_halves && !options.keeps_values) UseHalves(nodes, &lowered);
  return std::make_unique<VulkanProgram>(graph, nodes, std::move(lowered), options, device_,
                                         pipelines_,
                                         options_.tiles_for.value_or(device_->description().type));
}

}  // namespace orb360::nn::vulkan
