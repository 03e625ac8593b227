#include <map>
#include <string>

#include "apps/orb360/commands.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/vulkan/devices.h>

namespace orb360 {

nn::Device DeviceOptions::Open() const {
  nn::Device device = nn::OpenDevice(name, uses_halves);
  const bool is_short = precision == nn::Precision::kBFloat16 || precision == nn::Precision::kInt8;
  // With "auto" it is for where the CPU runs the network.
  if (device.backend != nullptr && is_short && name != "auto") {
    throw UserError(
        "--precision bfloat16 and int8 are for the CPU: leave it out, or use --device cpu");
  }
  device.precision = precision;
  return device;
}

std::string PassedOverWarning(const nn::Device& device) {
  return "networks run on " + device.name + ", since " + device.passed_over + " cannot be used";
}

void AddDeviceOptions(CLI::App* command, DeviceOptions* device) {
  command
      ->add_option("--device", device->name,
                   "Processor of the network: cpu; auto, the first GPU or else the CPU; vulkan or "
                   "vulkan:N, a device of `orb360 devices`")
      ->type_name("cpu|auto|vulkan[:N]")
      ->capture_default_str();
  command->add_flag("--float16", device->uses_halves,
                    "Keep results of convolutions as 16-bit floats on a GPU: less traffic of its "
                    "memory, and less exact");
  const std::map<std::string, nn::Precision> precisions = {{"auto", nn::Precision::kAuto},
                                                           {"float", nn::Precision::kFloat},
                                                           {"bfloat16", nn::Precision::kBFloat16},
                                                           {"int8", nn::Precision::kInt8}};
  command
      ->add_option("--precision", device->precision,
                   "Type in which the network's convolutions multiply on the CPU: float; bfloat16 "
                   "or int8, faster and less exact, on processors that have it; or auto, what is "
                   "fastest on this processor without being noticeably less exact")
      ->transform(CLI::CheckedTransformer(precisions).description(""))
      ->type_name("auto|float|bfloat16|int8")
      ->default_str("auto");
}

}  // namespace orb360
