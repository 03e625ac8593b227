#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "nn/graph/buffer_assignment.h"
#include "nn/graph/fusion.h"
#include "nn/graph/lowering.h"
#include "nn/graph/program.h"
#include "nn/vulkan/buffer.h"
#include "nn/vulkan/commands.h"
#include "nn/vulkan/dispatch.h"
#include "nn/vulkan/dispatches.h"
#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/pipelines.h"
#include "nn/vulkan/timestamps.h"

namespace orb360::nn::vulkan {

/// A network on a device: weights in its memory, and the launches of one run.
class VulkanProgram : public Program {
 public:
  /// Tiles are chosen as for a device of the kind `tiles_for`. Throws DeviceError where the device
  /// has too little memory or its driver fails.
  VulkanProgram(const Graph& graph, std::span<const FusedNode> nodes, Lowered lowered,
                const ProgramOptions& options, std::shared_ptr<const LogicalDevice> device,
                std::shared_ptr<Pipelines> pipelines, VulkanDevice::Type tiles_for);

  std::unique_ptr<ProgramMemory> Allocate() const override;
  void Run(std::span<const std::span<const float>> inputs,
           std::span<const std::span<float>> outputs, ProgramMemory* memory) const override;
  TensorView Find(const ProgramMemory& memory, int value) const override;
  std::vector<double> Times(const ProgramMemory& memory) const override;
  std::size_t planned_bytes() const override { return assignment_.bytes; }
  std::size_t naive_bytes() const override { return assignment_.separate_bytes; }

 private:
  Place PlaceOf(int value) const;
  std::vector<Place> PlacesOf(std::span<const int> values) const;
  /// Copies the weights to the device.
  void Upload(std::span<const float> constants);
  /// Records the launches of one run, and the times between instructions if they are measured.
  void Record(VkDescriptorSet set, Commands* commands, Timestamps* times) const;

  std::shared_ptr<const LogicalDevice> device_;
  std::shared_ptr<Pipelines> pipelines_;
  Lowered lowered_;
  BufferAssignment assignment_;
  ProgramOptions options_;
  std::vector<std::vector<Dispatch>> dispatches_;  // by instruction
  Buffer constants_;
};

}  // namespace orb360::nn::vulkan
