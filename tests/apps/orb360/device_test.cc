// The processor of the network: --device of run and complete, and `orb360 devices`.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/apps/orb360/program.h"
#include "tests/apps/orb360/run_fixture.h"
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr const char* kNoDevice = "there is no Vulkan device here";

/// Variables of the environment of programs that are started in its lifetime.
class Environment {
 public:
  explicit Environment(const std::map<std::string, std::string>& variables) {
    for (const auto& [name, value] : variables) {
      const char* const before = std::getenv(name.c_str());
      before_[name] = before != nullptr ? before : "";
      setenv(name.c_str(), value.c_str(), 1);
    }
  }
  ~Environment() {
    for (const auto& [name, value] : before_) {
      value.empty() ? unsetenv(name.c_str()) : setenv(name.c_str(), value.c_str(), 1);
    }
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  std::map<std::string, std::string> before_;
};

class DeviceTest : public RunTest {
 protected:
  DeviceTest() { WriteMeanNetwork(folder_ / "net.h5"); }

  nlohmann::json Devices() const {
    const ProgramResult result =
        RunOrb360({"devices", "--weights", folder_ / "net.h5", "--size", "64", "32", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out);
  }

  /// Whether there is any Vulkan device. One that does not work is a failure of the test.
  bool HasVulkan() const {
    const nlohmann::json found = Devices();
    if (found["devices"].size() > 1) return true;
    EXPECT_THAT(found["problem"].get<std::string>(),
                AnyOf(HasSubstr("No such file"), HasSubstr("there is no Vulkan driver"),
                      HasSubstr("there is no Vulkan device"), HasSubstr("built without Vulkan")));
    EXPECT_EQ(std::getenv("ORB360_TEST_REQUIRES_VULKAN"), nullptr) << kNoDevice;
    return false;
  }

  ProgramResult RunOn(const std::string& device) const {
    return Run({"--weights", folder_ / "net.h5", "--cloud-quality", "draft", "--save-depth",
                "--device", device});
  }

  ProgramResult Complete(const std::string& device, const std::string& out) const {
    cv::imwrite(folder_ / "image.png", cv::Mat(24, 48, CV_8UC3, cv::Scalar(10, 20, 30)));
    cv::Mat range = cv::Mat::zeros(24, 48, CV_32F);
    for (int i = 0; i < 20; ++i) range.at<float>(1 + i, 2 * i) = 2 + 0.5f * static_cast<float>(i);
    WriteDepthImage(folder_ / "sparse.png", range);
    return RunOrb360({"complete", "--image", folder_ / "image.png", "--sparse",
                      folder_ / "sparse.png", "--weights", folder_ / "net.h5", "--out",
                      folder_ / out, "--json", "--device", device});
  }
};

/// A driver that loses its device after that many submissions.
std::map<std::string, std::string> FailingDriver(int submissions) {
  return {{"LD_LIBRARY_PATH", ORB360_BINARY_DIR "/tests/apps/orb360/failing_vulkan"},
          {"ORB360_TEST_SUBMISSIONS", std::to_string(submissions)}};
}

/// A driver that cannot prepare a device for networks.
std::map<std::string, std::string> DriverWithoutPipelines() {
  return {{"LD_LIBRARY_PATH", ORB360_BINARY_DIR "/tests/apps/orb360/failing_vulkan"},
          {"ORB360_TEST_NO_PIPELINES", "1"}};
}

/// A driver with whose devices something is wrong (failing_vulkan.cc).
std::map<std::string, std::string> DriverWhoseDeviceIs(const std::string& what) {
  return {{"LD_LIBRARY_PATH", ORB360_BINARY_DIR "/tests/apps/orb360/failing_vulkan"},
          {"ORB360_TEST_DEVICE_IS", what}};
}

/// No driver at all.
const std::map<std::string, std::string> kNoDriver = {{"VK_ICD_FILENAMES", "/nonexistent.json"},
                                                      {"VK_DRIVER_FILES", "/nonexistent.json"}};

TEST_F(DeviceTest, TheCpuIsAlwaysListedAndMeasured) {
  for (const auto& variables : {std::map<std::string, std::string>(), kNoDriver}) {
    const Environment environment(variables);
    const nlohmann::json cpu = Devices()["devices"][0];
    EXPECT_EQ(cpu["device"], "cpu");
    EXPECT_GT(cpu["milliseconds"], 0.0);
  }
}

TEST_F(DeviceTest, WithoutADriverTheCpuIsTakenOrTheReasonTold) {
  const Environment environment(kNoDriver);
  EXPECT_THAT(Devices()["problem"].get<std::string>(), HasSubstr("Vulkan"));
  const ProgramResult automatic = Complete("auto", "auto.png");
  ASSERT_EQ(automatic.status, 0) << automatic.err;
  EXPECT_EQ(nlohmann::json::parse(automatic.out)[0]["device"], "cpu");
  const ProgramResult vulkan = Complete("vulkan", "vulkan.png");
  EXPECT_EQ(vulkan.status, 1);
  EXPECT_THAT(vulkan.err, AllOf(IsOneLine(), HasSubstr("--device vulkan: "), HasSubstr("Vulkan")));
}

TEST_F(DeviceTest, UnknownDevicesAreRefusedBeforeAnyWork) {
  WriteBlanks();
  const std::string net = folder_ / "net.h5";
  EXPECT_THAT(Refusal({"--weights", net, "--device", "gpu"}),
              HasSubstr("should be cpu, auto, vulkan or vulkan:N"));
  EXPECT_THAT(Refusal({"--weights", net, "--device", "vulkan:77"}), HasSubstr("vulkan:77: "));
  EXPECT_THAT(Refusal({"--weights", "none", "--device", "auto"}), HasSubstr("--device: without"));
}

TEST_F(DeviceTest, CompletesOnADeviceAsOnTheCpu) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  const ProgramResult cpu = Complete("cpu", "cpu.png");
  const ProgramResult vulkan = Complete("vulkan", "vulkan.png");
  ASSERT_EQ(cpu.status, 0) << cpu.err;
  ASSERT_EQ(vulkan.status, 0) << vulkan.err;
  EXPECT_THAT(nlohmann::json::parse(vulkan.out)[0]["device"].get<std::string>(),
              StartsWith("vulkan:"));
  const cv::Mat expected = ReadDepthImage(folder_ / "cpu.png");
  const cv::Mat actual = ReadDepthImage(folder_ / "vulkan.png");
  EXPECT_GT(cv::countNonZero(expected), 0);
  EXPECT_LE(cv::norm(expected, actual, cv::NORM_INF), 1.0 / 256);  // the unit of the file
}

TEST_F(DeviceTest, ADeviceThatCannotBeOpenedIsToldInOneLine) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  const Environment environment(DriverWithoutPipelines());
  const ProgramResult vulkan = Complete("vulkan", "vulkan.png");
  EXPECT_EQ(vulkan.status, 1);
  EXPECT_THAT(vulkan.err, AllOf(IsOneLine(), HasSubstr("--device vulkan: networks cannot run on"),
                                HasSubstr("could not prepare a shader")));
  const ProgramResult automatic = Complete("auto", "auto.png");
  EXPECT_EQ(automatic.status, 0) << automatic.err;
  EXPECT_EQ(nlohmann::json::parse(automatic.out)[0]["device"], "cpu");
  const nlohmann::json found = Devices()["devices"];
  ASSERT_GT(found.size(), 1u);
  EXPECT_GT(found[0]["milliseconds"], 0.0);
  for (std::size_t i = 1; i < found.size(); ++i) {
    EXPECT_TRUE(found[i]["milliseconds"].is_null());
    EXPECT_THAT(found[i]["problem"].get<std::string>(), HasSubstr("could not prepare a shader"));
  }
}

TEST_F(DeviceTest, WhatFailsWithHalvesOnlyIsListedBesideTheTime) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  // Floats take 23 submissions, those of the weights, of a first run and of 21 measured ones.
  const Environment environment(FailingDriver(30));
  const nlohmann::json found = Devices()["devices"][1];
  if (!found["float16"].get<bool>()) GTEST_SKIP() << "the device has no 16-bit floats";
  EXPECT_GT(found["milliseconds"], 0.0);
  EXPECT_EQ(found["problem"], "");
  EXPECT_TRUE(found["milliseconds_float16"].is_null());
  EXPECT_THAT(found["problem_float16"].get<std::string>(), HasSubstr("the device was lost"));
  const ProgramResult text =
      RunOrb360({"devices", "--weights", folder_ / "net.h5", "--size", "64", "32"});
  EXPECT_THAT(text.out, testing::ContainsRegex("vulkan:0 .* ms, with --float16: vulkan:0 .*"
                                               "the device was lost"));
}

TEST_F(DeviceTest, WhatADeviceLacksIsToldInOneLine) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  const std::map<std::string, std::string> reasons = {
      {"gpu old", "it has Vulkan 1.1.0, and 1.2 is needed"},
      {"gpu inexact", "it does not keep NaN and infinity"},
      {"hidden", "Vulkan cannot list its devices (vkEnumeratePhysicalDevices gave -3)"}};
  for (const auto& [what, reason] : reasons) {
    const Environment environment(DriverWhoseDeviceIs(what));
    for (const char* device : {"vulkan", "vulkan:0"}) {
      const ProgramResult result = Complete(device, "refused.png");
      EXPECT_EQ(result.status, 1) << what;
      EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("--device vulkan"), HasSubstr(reason)));
    }
    const ProgramResult automatic = Complete("auto", "auto.png");
    EXPECT_EQ(automatic.status, 0) << automatic.err;
    EXPECT_EQ(nlohmann::json::parse(automatic.out)[0]["device"], "cpu");
    if (what == "hidden") {
      EXPECT_THAT(Devices()["problem"].get<std::string>(), HasSubstr(reason));
    } else {
      EXPECT_THAT(Devices()["devices"][1]["problem"].get<std::string>(), HasSubstr(reason));
      EXPECT_THAT(automatic.err,
                  AllOf(IsOneLine(), HasSubstr("warning: networks run on cpu, since vulkan:0 ("),
                        HasSubstr(reason)));
    }
  }
}

TEST_F(DeviceTest, ARunTellsWhichGpuItCouldNotUse) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  WriteRoom();
  const Environment environment(DriverWhoseDeviceIs("gpu old"));
  const ProgramResult result = RunOn("auto");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("warning: networks run on cpu, since")));
  EXPECT_EQ(Summary()["device"], "cpu");
  EXPECT_EQ(Summary()["warnings"].size(), 1u);
}

TEST_F(DeviceTest, ATypeOfTheCpuIsRefusedForANamedDeviceOnly) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  WriteBlanks();
  EXPECT_THAT(
      Refusal({"--weights", folder_ / "net.h5", "--device", "vulkan", "--precision", "int8"}),
      HasSubstr("are for the CPU"));
  WriteRoom();
  const Environment environment(DriverWhoseDeviceIs("gpu"));
  const ProgramResult result = Run({"--weights", folder_ / "net.h5", "--cloud-quality", "draft",
                                    "--device", "auto", "--precision", "int8"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(Summary()["device"].get<std::string>(), StartsWith("vulkan:0"));
}

TEST_F(DeviceTest, AnImageTooLargeForTheDeviceIsCompletedOnTheCpu) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  ASSERT_EQ(Complete("cpu", "cpu.png").status, 0);
  const Environment environment(DriverWhoseDeviceIs("small"));
  const ProgramResult result = Complete("vulkan", "vulkan.png");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("MiB in one buffer"), HasSubstr("CPU")));
  EXPECT_EQ(nlohmann::json::parse(result.out)[0]["device"], "cpu");
  EXPECT_EQ(ReadText(folder_ / "vulkan.png"), ReadText(folder_ / "cpu.png"));
}

TEST_F(DeviceTest, ALoaderThatCannotBeOpenedIsNotCalledMissing) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  std::ofstream(folder_ / "libvulkan.so.1") << std::string(1000, 'x');  // no library
  const std::map<std::string, std::string> variables = {
      {"LD_LIBRARY_PATH", (folder_ / ".").string()}};
  const Environment environment(variables);
  const ProgramResult vulkan = Complete("vulkan", "vulkan.png");
  EXPECT_EQ(vulkan.status, 1);
  EXPECT_THAT(vulkan.err, AllOf(IsOneLine(), HasSubstr("libvulkan.so.1: invalid ELF header"),
                                HasSubstr("--device cpu")));
}

TEST_F(DeviceTest, ARunStatesItsDevice) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  WriteRoom();
  const ProgramResult result = RunOn("vulkan");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(Summary()["device"].get<std::string>(), StartsWith("vulkan:"));
  EXPECT_GT(Summary()["cloud"]["points"], 0);
}

// The bounds of docs/concepts/vulkan.md.
TEST_F(DeviceTest, TheDeviceChangesThePathOnlyWhereDepthGuidesMapping) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  WriteRoom();
  const auto run = [&](const std::string& device, const std::string& config) {
    WriteText(folder_ / "run.yaml", config);
    const ProgramResult result = Run({"--weights", folder_ / "net.h5", "--cloud-quality", "draft",
                                      "--config", folder_ / "run.yaml", "--device", device});
    EXPECT_EQ(result.status, 0) << result.err;
    return ReadText(OutFile("trajectory.txt"));
  };
  EXPECT_EQ(run("cpu", ""), run("vulkan", ""));

  const std::string guided = "depth:\n  guides_mapping: true\n";
  run("cpu", guided);
  const std::vector<StampedPose> expected = ReadTrajectory(OutFile("trajectory.txt"));
  run("vulkan", guided);
  const std::vector<StampedPose> actual = ReadTrajectory(OutFile("trajectory.txt"));
  ASSERT_EQ(actual.size(), expected.size());
  const double length = expected.back().world_from_camera.translation.norm();
  ASSERT_GT(length, 0);
  for (size_t i = 0; i < actual.size(); ++i) {
    const Rigid3 difference = expected[i].world_from_camera.Inverse() * actual[i].world_from_camera;
    EXPECT_LT(difference.translation.norm(), 1e-3 * length) << i;
    EXPECT_LT(difference.rotation.vec().norm(), 1e-4) << i;
  }
}

TEST_F(DeviceTest, ARunWhoseDeviceIsLostGoesOnWithTheCpuAndWarnsOnce) {
  if (!HasVulkan()) GTEST_SKIP() << kNoDevice;
  WriteRoom();
  ASSERT_EQ(RunOn("cpu").status, 0);
  const nlohmann::json expected = Summary();
  const std::string cloud = ReadText(OutFile("cloud.ply"));
  EXPECT_EQ(expected["device"], "cpu");
  for (const int submissions : {0, 2}) {  // the weights and one image
    std::filesystem::remove_all(Out());
    const Environment environment(FailingDriver(submissions));
    const ProgramResult result = RunOn("vulkan");
    EXPECT_EQ(result.status, 0);
    EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("warning: vulkan:"),
                                  HasSubstr("the device was lost"), HasSubstr("on the CPU")));
    const nlohmann::json summary = Summary();
    EXPECT_EQ(summary["device"], "cpu");
    EXPECT_EQ(summary["warnings"].size(), 1u);
    EXPECT_EQ(summary["cloud"]["views"], expected["cloud"]["views"]);
    if (submissions == 0) {
      EXPECT_TRUE(ReadText(OutFile("cloud.ply")) == cloud);
    }
  }
}

}  // namespace
}  // namespace orb360
