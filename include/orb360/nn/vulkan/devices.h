#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <orb360/nn/graph/device.h>

namespace orb360::nn {

/// A device as its Vulkan driver describes it.
struct VulkanDevice {
  /// Kinds of devices.
  enum class Type : std::uint8_t {
    kDiscrete,    ///< A graphics card with memory of its own.
    kIntegrated,  ///< A graphics processor that shares the memory of the CPU.
    kVirtual,     ///< A graphics processor as a virtual machine shows it.
    kCpu,         ///< A driver that computes on the CPU, such as lavapipe.
    kOther,       ///< What the driver does not name.
  };

  int index = 0;                       ///< N of "vulkan:N": the driver's order.
  std::string name;                    ///< Name of the device.
  std::string driver;                  ///< Name and version of the driver.
  std::string api_version;             ///< Version of Vulkan, such as "1.3.230".
  Type type = Type::kOther;            ///< Kind of the device.
  std::uint64_t memory_bytes = 0;      ///< Size of the largest heap of its own memory.
  std::uint64_t max_buffer_bytes = 0;  ///< Largest buffer that a shader can read.
  int max_invocations = 0;             ///< Largest number of invocations in a workgroup.
  int shared_bytes = 0;                ///< Memory that a workgroup shares.
  int subgroup_size = 0;               ///< Invocations that run in lockstep.
  bool has_float16 = false;            ///< Whether shaders can read and write 16-bit floats.
  /// Why networks cannot run on it; empty where they can.
  std::string problem;
};

/// Returns "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other".
const char* NameOf(VulkanDevice::Type type);

/// What ListVulkanDevices has found.
struct VulkanDevices {
  std::vector<VulkanDevice> devices;  ///< All devices, also those on which networks cannot run.
  /// Why there is no Vulkan (a build without it, no driver); empty where `devices` is right.
  std::string problem;
};

/// Asks all Vulkan drivers of this machine for their devices.
VulkanDevices ListVulkanDevices();

/// Opens a processor for networks (ExecutorOptions::device) by name: "cpu"; "auto", the first GPU
/// on which networks can run, never a driver that computes on the CPU, or else the CPU; "vulkan",
/// the first GPU or else the first device; "vulkan:N", the device of that index. A device that its
/// driver cannot open is passed over as one on which networks cannot run. Throws UserError, which
/// says what was found, where there is no such device or networks cannot run on it.
///
/// With `uses_halves` the device keeps the results of most convolutions as 16-bit floats, which
/// halves the traffic of its memory and is less exact; sums still have 32 bits. Throws UserError
/// where a named device, or the CPU, cannot; "auto" uses them where it finds a GPU that can.
Device OpenDevice(const std::string& name, bool uses_halves = false);

/// What a device can do at most, measured now.
struct DevicePeaks {
  double operations = 0;  ///< 10^9 a second, of multiplications and additions of 32-bit floats.
  double bandwidth = 0;   ///< 10^9 bytes a second, read and written by copies in its memory.
};

/// Measures each several times, for some milliseconds, and returns the best. Throws DeviceError
/// where the device cannot measure times, has too little memory or fails.
/// Contract: not of the CPU.
DevicePeaks MeasurePeaks(const Device& device);

}  // namespace orb360::nn
