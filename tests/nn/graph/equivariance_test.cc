// What must hold for every panorama, whatever the weights are.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/nn/dump.h"
#include "tests/nn/graph/dump_run.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/graph/network_file.h>

namespace orb360::nn {
namespace {

/// `image` turned to the right by so many columns.
DumpedTensor Rolled(const DumpedTensor& image, int columns) {
  DumpedTensor rolled = image;
  const int width = image.shape.width;
  for (std::size_t i = 0; i < image.values.size(); i += static_cast<std::size_t>(width)) {
    const auto row = rolled.values.begin() + static_cast<std::ptrdiff_t>(i);
    std::rotate(row, row + (width - columns % width), row + width);
  }
  return rolled;
}

float FarthestApart(const DumpedTensor& a, const DumpedTensor& b) {
  EXPECT_EQ(a.values.size(), b.values.size());
  float farthest = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    farthest = std::max(farthest, std::abs(a.values[i] - b.values[i]));
  }
  return farthest;
}

/// The project's own network with few channels and weights of a seed, on a random image.
class PanoramaNetwork : public ::testing::TestWithParam<int> {
 protected:
  PanoramaNetwork() {
    const Shape shape{1, 128, 384};
    const auto random = [&](int channels, float low, float high, unsigned seed) {
      const Shape size{channels, shape.height, shape.width};
      const PlainImage image = RandomImage(size, low, high, seed);
      return DumpedTensor{size, {image.values.begin(), image.values.end()}};
    };
    inputs_["image"] = random(3, 0, 1, 1);
    inputs_["depth"] = random(1, 1, 80, 2);
    inputs_["confidence"] = random(1, 0, 1, 3);
    constexpr float kUnknown = 0.95F;  // fraction of the pixels without a depth
    for (float& confidence : inputs_["confidence"].values) {
      confidence = std::max(confidence - kUnknown, 0.0F) / (1 - kUnknown);
    }
  }

  Dump Outputs(const Dump& inputs) const {
    return DumpRun(graph_, inputs, {.threads = GetParam()}).outputs();
  }

  const Graph graph_ =
      ReadNetwork(std::filesystem::path(ORB360_SOURCE_DIR) / "tests/nn/data/depth_completion.h5");
  Dump inputs_;
};

TEST_P(PanoramaNetwork, TurnsItsResultWithTheImageBitForBit) {
  const Dump outputs = Outputs(inputs_);
  // The lowest level has a pixel for 128 of the image's.
  for (const int columns : {128, 256}) {
    Dump turned;
    for (const auto& [name, input] : inputs_) turned[name] = Rolled(input, columns);
    const Dump result = Outputs(turned);
    for (const char* const name : {"log_depth", "confidence", "scale"}) {
      EXPECT_TRUE(result.at(name).values == Rolled(outputs.at(name), columns).values)
          << name << " turned by " << columns;
    }
    // A mean over the image is added up in another order.
    EXPECT_LE(FarthestApart(result.at("log_metric_scale"), outputs.at("log_metric_scale")), 1e-6F);
  }
}

TEST_P(PanoramaNetwork, DoesNotDependOnTheUnitOfDepth) {
  const Dump outputs = Outputs(inputs_);
  const auto with_unit = [&](float metres) {
    Dump inputs = inputs_;
    for (float& depth : inputs["depth"].values) depth *= metres;
    return Outputs(inputs);
  };
  // A power of two only changes exponents.
  const Dump exact = with_unit(0.125F);
  for (const char* const name : {"log_depth", "confidence", "log_metric_scale"}) {
    EXPECT_TRUE(exact.at(name).values == outputs.at(name).values) << name;
  }
  EXPECT_EQ(exact.at("scale").values[0], 0.125F * outputs.at("scale").values[0]);
  const Dump rounded = with_unit(0.1F);
  for (const char* const name : {"log_depth", "confidence", "log_metric_scale"}) {
    EXPECT_LE(FarthestApart(rounded.at(name), outputs.at(name)), 2e-6F) << name;
  }
}

TEST_P(PanoramaNetwork, SeesPointsAndImage) {
  const Dump outputs = Outputs(inputs_);
  for (const char* const name : {"image", "depth"}) {
    Dump inputs = inputs_;
    std::ranges::reverse(inputs[name].values);
    EXPECT_GT(FarthestApart(Outputs(inputs).at("log_depth"), outputs.at("log_depth")), 1e-3F)
        << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, PanoramaNetwork, ::testing::Values(1, 2),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace orb360::nn
