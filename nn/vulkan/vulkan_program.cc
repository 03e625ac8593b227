#include "nn/vulkan/vulkan_program.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "nn/vulkan/commands.h"
#include "nn/vulkan/descriptors.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn::vulkan {
namespace {

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

/// Bytes of an input or output, which are 32-bit floats, as it lies in memory.
std::size_t BytesOf(const Place& place) {
  return Index(place.shape.channels) * place.plane * sizeof(float);
}

/// Distances in floats between the rows and the planes of an input or output.
struct Strides {
  std::size_t row;
  std::size_t plane;
};

Strides StridesOf(const Place& place) { return {place.row, place.plane}; }

/// Of the caller's memory.
Strides DenseStrides(const Shape& shape) {
  return {Index(shape.width), Index(shape.width) * Index(shape.height)};
}

void CopyRows(const float* from, const Strides& from_strides, float* to, const Strides& to_strides,
              const Shape& shape) {
  for (std::size_t channel = 0; channel < Index(shape.channels); ++channel) {
    for (std::size_t y = 0; y < Index(shape.height); ++y) {
      std::memcpy(to + channel * to_strides.plane + y * to_strides.row,
                  from + channel * from_strides.plane + y * from_strides.row,
                  Index(shape.width) * sizeof(float));
    }
  }
}

struct VulkanMemory : ProgramMemory {
  VulkanMemory(const Program* program, std::shared_ptr<const LogicalDevice> of)
      : ProgramMemory(program), device(std::move(of)), commands(*device) {}

  std::shared_ptr<const LogicalDevice> device;  // declared first: destroyed after what is its
  Buffer upload;
  Buffer arena;
  Buffer download;
  Owned<VkDescriptorPool> descriptors;
  std::optional<Timestamps> times;
  bool has_run = false;
  Commands commands;  // declared last: destroyed before what they use
};

/// Throws DeviceError for more than shaders can address on the device.
void RequireBufferOf(const LogicalDevice& device, std::size_t bytes) {
  if (bytes <= device.description().max_buffer_bytes) return;
  throw DeviceError(device.name() + " could not prepare a network: it needs " +
                    std::to_string(bytes >> 20) + " MiB in one buffer, and the device has up to " +
                    std::to_string(device.description().max_buffer_bytes >> 20) + " MiB");
}

/// Scratch memory of each instruction.
std::vector<std::size_t> ScratchOf(const Lowered& lowered, std::span<const FusedNode> nodes) {
  std::vector<std::size_t> bytes;
  for (const Instruction& instruction : lowered.instructions) {
    const auto* const node = std::get_if<std::size_t>(&instruction.work);
    bytes.push_back(node != nullptr ? ScratchBytes(nodes[*node].node.operation) : 0);
  }
  return bytes;
}

}  // namespace

VulkanProgram::VulkanProgram(const Graph& graph, std::span<const FusedNode> nodes, Lowered lowered,
                             const ProgramOptions& options,
                             std::shared_ptr<const LogicalDevice> device,
                             std::shared_ptr<Pipelines> pipelines, VulkanDevice::Type tiles_for)
    : device_(std::move(device)),
      pipelines_(std::move(pipelines)),
      lowered_(std::move(lowered)),
      assignment_(AssignBuffers(lowered_, ScratchOf(lowered_, nodes), options.keeps_values)),
      options_(options) {
  if (options.measures_times) device_->RequireClock();
  RequireBufferOf(*device_, assignment_.bytes);
  Constants constants;
  for (std::size_t i = 0; i < lowered_.instructions.size(); ++i) {
    const Instruction& instruction = lowered_.instructions[i];
    Operands operands{PlacesOf(instruction.inputs), PlacesOf(instruction.outputs),
                      static_cast<std::uint32_t>(assignment_.scratch[i] / sizeof(float))};
    if (const auto* const copy = std::get_if<ChannelCopy>(&instruction.work)) {
      Place& from = operands.inputs.front();
      Place& to = operands.outputs.front();
      from.offset += static_cast<std::uint32_t>(copy->from_first) * from.plane;
      to.offset += static_cast<std::uint32_t>(copy->to_first) * to.plane;
      from.shape.channels = to.shape.channels = copy->count;
      dispatches_.push_back({CopyOf(from, to)});
      continue;
    }
    dispatches_.push_back(DispatchesOf(graph, nodes[std::get<std::size_t>(instruction.work)],
                                       operands, tiles_for, &constants));
  }
  Upload(constants.values());
}

Place VulkanProgram::PlaceOf(int value) const {
  const BufferAssignment::Buffer& buffer = assignment_.buffers[Index(value)];
  const auto plane = static_cast<std::uint32_t>(buffer.whole.plane_stride());
  const DataType type = lowered_.values[Index(value)].format.type;
  return {lowered_.values[Index(value)].format.shape, type == DataType::kFloat16,
          static_cast<std::uint32_t>(buffer.offset / SizeOf(type)) +
              static_cast<std::uint32_t>(buffer.first_channel) * plane,
          static_cast<std::uint32_t>(buffer.whole.row_stride()), plane};
}

std::vector<Place> VulkanProgram::PlacesOf(std::span<const int> values) const {
  std::vector<Place> places;
  for (const int value : values) places.push_back(PlaceOf(value));
  return places;
}

void VulkanProgram::Upload(std::span<const float> constants) {
  RequireBufferOf(*device_, constants.size_bytes());
  constants_ = Buffer(*device_, constants.size_bytes(), BufferUse::kDevice);
  if (constants.empty()) return;
  const Buffer upload(*device_, constants.size_bytes(), BufferUse::kUpload);
  std::memcpy(upload.data(), constants.data(), constants.size_bytes());
  Commands commands(*device_);
  commands.CopyBuffer(upload.get(), 0, constants_.get(), 0, constants.size_bytes());
  commands.Finish();
  commands.RunAndWait();
}

std::unique_ptr<ProgramMemory> VulkanProgram::Allocate() const {
  auto memory = std::make_unique<VulkanMemory>(this, device_);
  std::size_t upload = 0;
  std::size_t download = 0;
  for (const int input : lowered_.inputs) upload += BytesOf(PlaceOf(input));
  for (const int output : lowered_.outputs) download += BytesOf(PlaceOf(output));
  if (options_.keeps_values) download = assignment_.bytes;
  memory->upload = Buffer(*device_, upload, BufferUse::kUpload);
  memory->arena = Buffer(*device_, assignment_.bytes, BufferUse::kDevice);
  memory->download = Buffer(*device_, download, BufferUse::kDownload);
  Descriptors bound =
      Bind(*device_, pipelines_->set_layout(), {memory->arena.get(), constants_.get()});
  memory->descriptors = std::move(bound.pool);

  Commands& commands = memory->commands;
  Timestamps* times = nullptr;
  if (options_.measures_times) {
    // Before the inputs, behind them, behind each instruction and behind the outputs.
    times = &memory->times.emplace(*device_, static_cast<std::uint32_t>(dispatches_.size()) + 3);
    times->Reset(commands.get());
    times->Write(commands.get());
  }
  std::size_t at = 0;
  for (const int input : lowered_.inputs) {
    const Place place = PlaceOf(input);
    commands.CopyBuffer(memory->upload.get(), at, memory->arena.get(), place.offset * sizeof(float),
                        BytesOf(place));
    at += BytesOf(place);
  }
  Record(bound.set, &commands, times);
  at = 0;
  for (const int output : lowered_.outputs) {
    if (options_.keeps_values) break;
    const Place place = PlaceOf(output);
    commands.CopyBuffer(memory->arena.get(), place.offset * sizeof(float), memory->download.get(),
                        at, BytesOf(place));
    at += BytesOf(place);
  }
  if (options_.keeps_values) {
    commands.CopyBuffer(memory->arena.get(), 0, memory->download.get(), 0, assignment_.bytes);
  }
  if (times != nullptr) times->Write(commands.get());
  commands.Finish();
  return memory;
}

void VulkanProgram::Record(VkDescriptorSet set, Commands* commands, Timestamps* times) const {
  const DeviceFunctions& functions = device_->functions();
  functions.CmdBindDescriptorSets(commands->get(), VK_PIPELINE_BIND_POINT_COMPUTE,
                                  pipelines_->layout(), 0, 1, &set, 0, nullptr);
  commands->Barrier();
  if (times != nullptr) times->Write(commands->get());
  for (const std::vector<Dispatch>& of_instruction : dispatches_) {
    for (const auto& [pipeline, parameters, groups] : of_instruction) {
      functions.CmdBindPipeline(commands->get(), VK_PIPELINE_BIND_POINT_COMPUTE,
                                pipelines_->Get(pipeline));
      functions.CmdPushConstants(
          commands->get(), pipelines_->layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
          static_cast<std::uint32_t>(parameters.size() * sizeof(std::uint32_t)), parameters.data());
      functions.CmdDispatch(commands->get(), groups[0], groups[1], groups[2]);
      // Also before what does not read the result: memory is used again by later tensors.
      commands->Barrier();
    }
    if (times != nullptr) times->Write(commands->get());
  }
}

void VulkanProgram::Run(std::span<const std::span<const float>> inputs,
                        std::span<const std::span<float>> outputs, ProgramMemory* memory) const {
  ORB360_CHECK(memory->IsOf(this), "a workspace of another executor");
  auto& vulkan = static_cast<VulkanMemory&>(*memory);
  std::byte* to = vulkan.upload.data();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const Place place = PlaceOf(lowered_.inputs[i]);
    CopyRows(inputs[i].data(), DenseStrides(place.shape), reinterpret_cast<float*>(to),
             StridesOf(place), place.shape);
    to += BytesOf(place);
  }
  vulkan.commands.RunAndWait();
  vulkan.has_run = true;
  vulkan.download.Invalidate(*device_);
  const std::byte* from = vulkan.download.data();
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const Place place = PlaceOf(lowered_.outputs[i]);
    if (options_.keeps_values) from = vulkan.download.data() + place.offset * sizeof(float);
    CopyRows(reinterpret_cast<const float*>(from), StridesOf(place), outputs[i].data(),
             DenseStrides(place.shape), place.shape);
    from += BytesOf(place);
  }
}

TensorView VulkanProgram::Find(const ProgramMemory& memory, int value) const {
  ORB360_CHECK(options_.keeps_values);
  ORB360_CHECK(memory.IsOf(this), "a workspace of another executor");
  const auto& vulkan = static_cast<const VulkanMemory&>(memory);
  return ViewOf(assignment_.buffers[Index(value)],
                lowered_.values[Index(value)].format.shape.channels, vulkan.download.data());
}

std::vector<double> VulkanProgram::Times(const ProgramMemory& memory) const {
  ORB360_CHECK(options_.measures_times);
  ORB360_CHECK(memory.IsOf(this), "a workspace of another executor");
  const auto& vulkan = static_cast<const VulkanMemory&>(memory);
  return vulkan.has_run ? vulkan.times->Intervals() : std::vector<double>();
}

}  // namespace orb360::nn::vulkan
