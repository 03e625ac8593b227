#include "nn/vulkan/choose_device.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr std::string_view kPrefix = "vulkan:";

/// N of "vulkan:N".
std::optional<int> IndexOf(const std::string& name) {
  if (!name.starts_with(kPrefix)) return {};
  const std::string digits = name.substr(kPrefix.size());
  constexpr std::size_t kMaxDigits = 9;  // of an int
  const bool is_number =
      !digits.empty() && digits.size() <= kMaxDigits &&
      std::ranges::all_of(digits, [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!is_number) return {};
  return std::stoi(digits);
}

bool IsGpu(const VulkanDevice& device) {
  using enum VulkanDevice::Type;
  return device.type == kDiscrete || device.type == kIntegrated || device.type == kVirtual;
}

std::string List(const std::vector<VulkanDevice>& devices) {
  std::string text;
  for (const VulkanDevice& device : devices) {
    if (!text.empty()) text += ", ";
    text += "vulkan:" + std::to_string(device.index) + " (" + device.name;
    if (!device.problem.empty()) text += "; " + device.problem;
    text += ")";
  }
  return text.empty() ? "no device" : text;
}

/// The graphics processors that are not taken although there is no better one.
std::string PassedOver(const VulkanDevices& found, const std::optional<int>& chosen) {
  VulkanDevices passed_over;
  for (const VulkanDevice& device : found.devices) {
    if (chosen == device.index && IsGpu(device)) break;
    if (IsGpu(device)) passed_over.devices.push_back(device);
  }
  return passed_over.devices.empty() ? "" : List(passed_over.devices);
}

}  // namespace

const char* NameOf(VulkanDevice::Type type) {
  switch (type) {
    case VulkanDevice::Type::kDiscrete:
      return "discrete GPU";
    case VulkanDevice::Type::kIntegrated:
      return "integrated GPU";
    case VulkanDevice::Type::kVirtual:
      return "virtual GPU";
    case VulkanDevice::Type::kCpu:
      return "CPU";
    case VulkanDevice::Type::kOther:
      break;
  }
  return "other";
}

void CheckDeviceName(const std::string& name) {
  if (name == "cpu" || name == "auto" || name == "vulkan" || IndexOf(name)) return;
  throw UserError("device \"" + name + "\" should be cpu, auto, vulkan or vulkan:N (`orb360 " +
                  "devices` lists them)");
}

bool ChooseHalves(const std::string& name, const VulkanDevice* device, bool wanted) {
  if (!wanted || name == "auto") return wanted && device != nullptr && device->has_float16;
  if (device == nullptr) {
    throw UserError(
        "--float16 is for graphics processors: leave it out, or choose one by --device");
  }
  if (device->has_float16) return true;
  throw UserError("--float16: " + device->name + " cannot read and write 16-bit floats");
}

std::optional<int> ChooseDevice(const std::string& name, const VulkanDevices& found) {
  CheckDeviceName(name);
  if (name == "cpu") return {};
  const auto good_gpu = [](const VulkanDevice& device) {
    return device.problem.empty() && IsGpu(device);
  };
  const auto gpu = std::ranges::find_if(found.devices, good_gpu);
  if (name == "auto") {
    return gpu != found.devices.end() ? std::optional(gpu->index) : std::nullopt;
  }
  if (!found.problem.empty()) throw UserError("--device " + name + ": " + found.problem);
  if (const std::optional<int> index = IndexOf(name)) {
    const auto device = std::ranges::find(found.devices, *index, &VulkanDevice::index);
    if (device == found.devices.end()) {
      throw UserError("--device " + name + ": there is no such device; found " +
                      List(found.devices));
    }
    if (device->problem.empty()) return *index;
    throw UserError("--device " + name + ": networks cannot run on " + device->name + ": " +
                    device->problem);
  }
  if (gpu != found.devices.end()) return gpu->index;
  const auto any = std::ranges::find_if(
      found.devices, [](const VulkanDevice& device) { return device.problem.empty(); });
  if (any != found.devices.end()) return any->index;
  throw UserError("--device " + name + ": networks cannot run on any device; found " +
                  List(found.devices));
}

Device OpenChosen(const std::string& name, VulkanDevices found, bool uses_halves,
                  const OpenByIndex& open) {
  for (;;) {
    const std::optional<int> index = ChooseDevice(name, found);
    VulkanDevice* const chosen =
        index ? &*std::ranges::find(found.devices, *index, &VulkanDevice::index) : nullptr;
    const bool stores_halves = ChooseHalves(name, chosen, uses_halves);
    const bool is_open = name == "auto" || name == "vulkan";
    const std::string passed_over = is_open ? PassedOver(found, index) : "";
    if (chosen == nullptr) return {.passed_over = passed_over};
    try {
      Device device = open(*index, stores_halves);
      device.passed_over = passed_over;
      return device;
    } catch (const UserError& error) {
      chosen->problem = error.what();
    } catch (const DeviceError& error) {
      chosen->problem = error.what();
    }
  }
}

}  // namespace orb360::nn
