#include "nn/vulkan/pipelines.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace orb360::nn::vulkan {
namespace {

constexpr const char* kAction = "prepare a shader";

}  // namespace

Pipelines::Pipelines(std::shared_ptr<const LogicalDevice> device) : device_(std::move(device)) {
  const DeviceFunctions& functions = device_->functions();
  std::array<VkDescriptorSetLayoutBinding, 2> bindings{};
  for (std::uint32_t i = 0; i < bindings.size(); ++i) {
    bindings[i].binding = i;
    bindings[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    bindings[i].descriptorCount = 1;
    bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
  }
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  device_->Check(functions.CreateDescriptorSetLayout(device_->handle(), &set, nullptr, &set_layout),
                 kAction);
  set_layout_ = device_->Own(set_layout, functions.DestroyDescriptorSetLayout);
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, kParameterBytes};
  VkPipelineLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  device_->Check(functions.CreatePipelineLayout(device_->handle(), &info, nullptr, &layout),
                 kAction);
  layout_ = device_->Own(layout, functions.DestroyPipelineLayout);
}

VkPipeline Pipelines::Get(const PipelineKey& key) {
  const std::lock_guard lock(mutex_);
  const auto found = made_.find(key);
  if (found != made_.end()) return found->second.get();
  return made_.emplace(key, Make(key)).first->second.get();
}

Owned<VkPipeline> Pipelines::Make(const PipelineKey& key) const {
  const DeviceFunctions& functions = device_->functions();
  const std::span<const std::uint32_t> code = CodeOf(key.shader);
  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module_info.codeSize = code.size_bytes();
  module_info.pCode = code.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  device_->Check(functions.CreateShaderModule(device_->handle(), &module_info, nullptr, &shader),
                 kAction);
  const Owned<VkShaderModule> owned = device_->Own(shader, functions.DestroyShaderModule);

  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < key.constants.size(); ++i) {
    entries.push_back(
        {i, static_cast<std::uint32_t>(i * sizeof(std::uint32_t)), sizeof(std::uint32_t)});
  }
  const VkSpecializationInfo constants{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                       key.constants.size() * sizeof(std::uint32_t),
                                       key.constants.data()};
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = shader;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &constants;
  info.layout = layout();
  VkPipeline pipeline = VK_NULL_HANDLE;
  device_->Check(functions.CreateComputePipelines(device_->handle(), VK_NULL_HANDLE, 1, &info,
                                                  nullptr, &pipeline),
                 kAction);
  return device_->Own(pipeline, functions.DestroyPipeline);
}

}  // namespace orb360::nn::vulkan
