#include "nn/vulkan/timestamps.h"

#include <cstddef>

#include <orb360/nn/base/check.h>

namespace orb360::nn::vulkan {
namespace {

constexpr const char* kAction = "measure times";

}  // namespace

Timestamps::Timestamps(const LogicalDevice& device, std::uint32_t count)
    : device_(device), count_(count) {
  ORB360_CHECK(device.clock().bits > 0);
  VkQueryPoolCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = count;
  VkQueryPool pool = VK_NULL_HANDLE;
  device.Check(device.functions().CreateQueryPool(device.handle(), &info, nullptr, &pool), kAction);
  pool_ = device.Own(pool, device.functions().DestroyQueryPool);
}

void Timestamps::Reset(VkCommandBuffer commands) const {
  device_.functions().CmdResetQueryPool(commands, pool_.get(), 0, count_);
}

void Timestamps::Write(VkCommandBuffer commands) {
  ORB360_CHECK(written_ < count_, written_, count_);
  device_.functions().CmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool_.get(),
                                        written_++);
}

std::vector<double> Timestamps::Intervals() const {
  ORB360_CHECK(written_ == count_, written_, count_);
  std::vector<std::uint64_t> ticks(count_);
  device_.Check(device_.functions().GetQueryPoolResults(
                    device_.handle(), pool_.get(), 0, count_, ticks.size() * sizeof(ticks[0]),
                    ticks.data(), sizeof(ticks[0]), VK_QUERY_RESULT_64_BIT),
                kAction);
  const std::uint32_t bits = device_.clock().bits;
  const std::uint64_t mask = bits < 64 ? (std::uint64_t{1} << bits) - 1 : ~std::uint64_t{0};
  std::vector<double> milliseconds;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    // Modulo the largest time, after which the clock begins anew.
    const auto passed = static_cast<double>((ticks[i] - ticks[i - 1]) & mask);
    milliseconds.push_back(1e-6 * device_.clock().nanoseconds * passed);
  }
  return milliseconds;
}

}  // namespace orb360::nn::vulkan
