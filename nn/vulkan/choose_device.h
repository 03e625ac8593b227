#pragma once

#include <optional>
#include <string>

#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn {

/// Returns which of the devices OpenDevice opens for `name`; none for the CPU. Throws UserError as
/// OpenDevice does.
std::optional<int> ChooseDevice(const std::string& name, const VulkanDevices& found);

/// Returns whether a device keeps results as 16-bit floats where `wanted`. Throws UserError as
/// OpenDevice does. `device` is null for the CPU.
bool ChooseHalves(const std::string& name, const VulkanDevice* device, bool wanted);

/// Throws UserError for a name that is none of OpenDevice's.
void CheckDeviceName(const std::string& name);

}  // namespace orb360::nn
