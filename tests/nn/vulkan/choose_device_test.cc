#include "nn/vulkan/choose_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

using enum VulkanDevice::Type;

VulkanDevices Machine(const std::vector<VulkanDevice::Type>& types) {
  VulkanDevices found;
  for (const VulkanDevice::Type type : types) {
    VulkanDevice device;
    device.index = static_cast<int>(found.devices.size());
    device.name = NameOf(type);
    device.type = type;
    found.devices.push_back(device);
  }
  return found;
}

std::string ErrorOf(const std::string& name, const VulkanDevices& found) {
  try {
    ChooseDevice(name, found);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(ChooseDevice, AutoTakesTheFirstGpuAndNeverADriverOnTheCpu) {
  EXPECT_EQ(ChooseDevice("auto", Machine({kCpu, kIntegrated, kDiscrete})), 1);
  EXPECT_EQ(ChooseDevice("auto", Machine({kCpu})), std::nullopt);
  EXPECT_EQ(ChooseDevice("auto", Machine({})), std::nullopt);
  EXPECT_EQ(ChooseDevice("auto", {{}, "no driver"}), std::nullopt);
  VulkanDevices found = Machine({kDiscrete, kIntegrated});
  found.devices[0].problem = "it is too old";
  EXPECT_EQ(ChooseDevice("auto", found), 1);
}

TEST(ChooseDevice, VulkanPrefersGpusAndTakesWhatThereIs) {
  EXPECT_EQ(ChooseDevice("vulkan", Machine({kCpu, kDiscrete})), 1);
  EXPECT_EQ(ChooseDevice("vulkan", Machine({kCpu})), 0);
  EXPECT_EQ(ChooseDevice("vulkan:0", Machine({kCpu, kDiscrete})), 0);
  EXPECT_EQ(ChooseDevice("cpu", Machine({kDiscrete})), std::nullopt);
}

TEST(ChooseDevice, SaysWhatWasFound) {
  EXPECT_THAT(ErrorOf("vulkan:7", Machine({kDiscrete})),
              testing::AllOf(testing::HasSubstr("vulkan:7"),
                             testing::HasSubstr("found vulkan:0 (discrete GPU)")));
  EXPECT_THAT(ErrorOf("vulkan:99999", Machine({kDiscrete})),
              testing::HasSubstr("there is no such device; found vulkan:0"));
  EXPECT_THAT(ErrorOf("vulkan", {{}, "there is no driver"}), testing::HasSubstr("no driver"));
  VulkanDevices old = Machine({kDiscrete});
  old.devices[0].problem = "it has Vulkan 1.0, and 1.2 is needed";
  EXPECT_THAT(ErrorOf("vulkan:0", old), testing::HasSubstr("1.2 is needed"));
  EXPECT_THAT(ErrorOf("vulkan", old), testing::HasSubstr("1.2 is needed"));
}

TEST(ChooseDevice, UsesHalvesWhereTheDeviceCan) {
  VulkanDevice device;
  EXPECT_FALSE(ChooseHalves("auto", nullptr, true));
  EXPECT_FALSE(ChooseHalves("auto", &device, true));
  EXPECT_THROW(ChooseHalves("vulkan", &device, true), UserError);
  EXPECT_THROW(ChooseHalves("cpu", nullptr, true), UserError);
  device.has_float16 = true;
  EXPECT_TRUE(ChooseHalves("auto", &device, true));
  EXPECT_TRUE(ChooseHalves("vulkan", &device, true));
  EXPECT_FALSE(ChooseHalves("vulkan", &device, false));
}

/// Opens devices of a machine whose first `broken` devices cannot be opened, in turn for either
/// reason.
OpenByIndex OpenAllBut(int broken) {
  return [broken](int index, bool) -> Device {
    if (index >= broken) return {"device " + std::to_string(index), nullptr};
    if (index % 2 == 0) throw DeviceError("it has no shaders");
    throw UserError("it is in use");
  };
}

TEST(OpenChosen, AutoGoesOnToTheNextGpuAndThenToTheCpu) {
  const VulkanDevices found = Machine({kDiscrete, kIntegrated, kVirtual, kCpu});
  EXPECT_EQ(OpenChosen("auto", found, false, OpenAllBut(0)).name, "device 0");
  EXPECT_EQ(OpenChosen("auto", found, false, OpenAllBut(1)).name, "device 1");
  EXPECT_EQ(OpenChosen("auto", found, false, OpenAllBut(2)).name, "device 2");
  EXPECT_EQ(OpenChosen("auto", found, false, OpenAllBut(3)).name, "cpu");
  EXPECT_EQ(OpenChosen("vulkan", found, false, OpenAllBut(3)).name, "device 3");
}

TEST(OpenChosen, TellsWhichGpusWerePassedOverAndWhy) {
  VulkanDevices found = Machine({kDiscrete, kCpu, kIntegrated});
  EXPECT_EQ(OpenChosen("auto", found, false, OpenAllBut(0)).passed_over, "");
  EXPECT_EQ(OpenChosen("auto", found, false, OpenAllBut(1)).passed_over,
            "vulkan:0 (discrete GPU; it has no shaders)");
  found.devices[2].problem = "it is too old";
  for (const char* name : {"auto", "vulkan"}) {
    EXPECT_EQ(
        OpenChosen(name, found, false, OpenAllBut(1)).passed_over,
        "vulkan:0 (discrete GPU; it has no shaders), vulkan:2 (integrated GPU; it is too old)")
        << name;
  }
  // Nobody asked for another one.
  EXPECT_EQ(OpenChosen("vulkan:1", found, false, OpenAllBut(1)).passed_over, "");
  EXPECT_EQ(OpenChosen("cpu", found, false, OpenAllBut(1)).passed_over, "");
  EXPECT_EQ(OpenChosen("auto", Machine({kCpu}), false, OpenAllBut(1)).passed_over, "");
}

TEST(OpenChosen, ANamedDeviceThatCannotBeOpenedIsAUserError) {
  const VulkanDevices found = Machine({kDiscrete, kIntegrated});
  const auto error_of = [&](const std::string& name) -> std::string {
    try {
      OpenChosen(name, found, false, OpenAllBut(2));
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of("vulkan:0"),
            "--device vulkan:0: networks cannot run on discrete GPU: it has no shaders");
  EXPECT_THAT(error_of("vulkan:1"), testing::HasSubstr("it is in use"));
  EXPECT_THAT(error_of("vulkan"), testing::AllOf(testing::HasSubstr("it has no shaders"),
                                                 testing::HasSubstr("it is in use")));
}

TEST(OpenChosen, TheHalvesOfAnotherGpuAreItsOwn) {
  VulkanDevices found = Machine({kDiscrete, kIntegrated});
  found.devices[0].has_float16 = true;
  const auto open = [](int index, bool stores_halves) -> Device {
    if (index == 0) throw DeviceError("it was lost");
    return {stores_halves ? "halves" : "floats", nullptr};
  };
  EXPECT_EQ(OpenChosen("auto", found, true, open).name, "floats");
}

TEST(ChooseDevice, RefusesOtherNames) {
  for (const char* name :
       {"", "gpu", "vulkan:", "vulkan:-1", "vulkan:1x", "vulkan:9999999999", "CPU"}) {
    EXPECT_THAT(ErrorOf(name, Machine({kDiscrete})),
                testing::HasSubstr("should be cpu, auto, vulkan or vulkan:N"))
        << name;
  }
}

}  // namespace
}  // namespace orb360::nn
