#pragma once

#include <memory>

#include "nn/vulkan/logical_device.h"
#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn::vulkan {

/// nn::MeasurePeaks of a device that is open.
DevicePeaks MeasurePeaks(const std::shared_ptr<const LogicalDevice>& device);

}  // namespace orb360::nn::vulkan
