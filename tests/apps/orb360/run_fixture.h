#pragma once

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "tests/apps/orb360/program.h"
#include "tests/apps/orb360/textured_room.h"
#include "tests/nn/graph/network_builder.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

inline const cv::Size kSize(384, 192);
inline constexpr int kFrames = 24;

/// A text of exactly one line.
MATCHER(IsOneLine, "") {
  return !arg.empty() && arg.back() == '\n' && std::ranges::count(arg, '\n') == 1;
}

/// A network that gives every pixel the mean of the points around it, or of all, and is sure of it.
inline void WriteMeanNetwork(const std::filesystem::path& path,
                             std::optional<double> ground = std::nullopt) {
  nn::NetworkBuilder net(8);
  net.Input("depth", 1);
  net.Input("confidence", 1);
  net.Node("points", "median_log", {"depth", "confidence"}, nlohmann::json::object(), 3);
  net.NormalizedConvolution("mean", "points", "points.1", 1, 1, 15);
  net.weights.back().values = {0};
  net.Node("sure", "affine", {"mean.1"}, {{"scale", 0.0}, {"offset", 0.97}});
  net.Output("log_depth", "mean");
  net.Output("confidence", "sure");
  net.Output("scale", "points.2");
  if (ground) {
    net.Node("below", "affine", {"mean.1"}, {{"scale", 0.0}, {"offset", *ground}});
    net.Output("ground", "below");
  }
  net.Write(path);
}

/// Runs orb360 on a folder of images of a room.
class RunTest : public testing::Test {
 protected:
  std::string Input() const { return folder_ / "input"; }
  std::string Out() const { return folder_ / "out"; }

  /// Without a network, which takes its time, unless one is asked for.
  ProgramResult Run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"run", Input(), "--out", Out(), "--threads", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (std::ranges::find(more, "--weights") == more.end()) {
      arguments.insert(arguments.end(), {"--weights", "none"});
    }
    return RunOrb360(arguments);
  }

  /// Exit status 1 and one line on standard error, which is returned.
  std::string Refusal(const std::vector<std::string>& more = {}) const {
    const ProgramResult result = Run(more);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, testing::AllOf(IsOneLine(), testing::StartsWith("orb360: ")));
    EXPECT_FALSE(std::filesystem::exists(Out())) << "nothing was done, so nothing is there";
    return result.err;
  }

  std::filesystem::path OutFile(const std::string& name) const { return folder_ / "out" / name; }
  nlohmann::json Summary() const {
    return nlohmann::json::parse(ReadText(OutFile("summary.json")), nullptr, false);
  }
  size_t PosesIn(const std::string& name) const { return ReadTrajectory(OutFile(name)).size(); }

  std::filesystem::path Image(int i) const {
    char name[32];
    std::snprintf(name, sizeof name, "%06d.png", i);
    return folder_ / "input" / name;
  }

  /// For what is refused before an image is looked at.
  void WriteBlanks() const {
    WriteFolder(Input(), std::vector<cv::Mat>(3, cv::Mat(kSize, CV_8UC1, cv::Scalar(99))));
  }
  void WriteRoom() const { WriteFolder(Input(), TexturedRoom(kSize).DrawAll(kFrames)); }

  TempFolder folder_;
};

}  // namespace orb360
