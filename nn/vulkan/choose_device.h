#pragma once

#include <functional>
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

/// Opens the device of that index, with 16-bit storage or without. May throw UserError and
/// DeviceError.
using OpenByIndex = std::function<Device(int index, bool stores_halves)>;

/// OpenDevice on a machine with the devices `found`. One that `open` cannot open counts as a device
/// on which networks cannot run, so that "auto" and "vulkan" go on to the next one.
Device OpenChosen(const std::string& name, VulkanDevices found, bool uses_halves,
                  const OpenByIndex& open);

/// Throws UserError for a name that is none of OpenDevice's.
void CheckDeviceName(const std::string& name);

}  // namespace orb360::nn
