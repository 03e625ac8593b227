#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "nn/graph/backend.h"
#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/pipelines.h"

namespace orb360::nn::vulkan {

/// How a VulkanBackend computes.
struct VulkanBackendOptions {
  /// The kind of device by which tiles are chosen; none: that of the device.
  std::optional<VulkanDevice::Type> tiles_for = {};
  /// Stores the results of most convolutions as 16-bit floats (half_storage.h).
  bool uses_halves = false;
};

/// The backend that runs networks by Vulkan on one device: tensors are planes of floats without
/// halo, and every node is one shader or a few.
class VulkanBackend : public Backend {
 public:
  /// Contract: the device has what `options` asks for.
  explicit VulkanBackend(std::shared_ptr<const LogicalDevice> device,
                         VulkanBackendOptions options = {});

  /// Normalized convolutions stay single: the intermediate results of a chain fit into no cache of
  /// a graphics processor.
  std::vector<FusedNode> Fuse(const Graph& graph) const override { return FuseConvolutions(graph); }
  NodeNeeds NeedsOf(const Graph& graph, const FusedNode& node) const override;
  std::unique_ptr<const Program> MakeProgram(const Graph& graph, std::span<const FusedNode> nodes,
                                             Lowered lowered, int height, int width,
                                             const ProgramOptions& options) const override;
  const std::shared_ptr<const LogicalDevice>& device() const { return device_; }

 private:
  std::shared_ptr<const LogicalDevice> device_;
  std::shared_ptr<Pipelines> pipelines_;
  VulkanBackendOptions options_;
};

}  // namespace orb360::nn::vulkan
