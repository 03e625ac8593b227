#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/vulkan_backend.h"
#include <orb360/nn/graph/executor.h>

namespace orb360::nn {

/// Tests on a Vulkan device with the validation layer, which must have nothing to say. They use the
/// device of the environment variable ORB360_TEST_DEVICE, or else what `--device vulkan` chooses.
/// They are skipped only where there is no device at all; one that does not work is a failure.
class VulkanTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Opens the device again, with functions replaced.
  Device OpenWith(const vulkan::LogicalDevice::Replace& replace);
  /// Opens the device again, as one whose buffers have at most that size.
  Device OpenWith(std::uint64_t max_buffer_bytes);
  /// Opens the device again.
  Device OpenWith(const vulkan::VulkanBackendOptions& how);

  /// For the device that SetUp has opened.
  ExecutorOptions options() const { return {.device = device_}; }

  Device device_;
  std::shared_ptr<const vulkan::Instance> instance_;
  int index_ = 0;

 private:
  std::mutex mutex_;  // of messages_: any thread may have one
  std::vector<std::string> messages_;
};

}  // namespace orb360::nn
