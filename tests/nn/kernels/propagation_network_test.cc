// What the network of normalized convolutions must be by its construction, whatever its weights.
#include "tests/nn/kernels/propagation_network.h"

#include <gtest/gtest.h>

#include "nn/kernels/median_log.h"
#include "tests/dispatch_targets.h"

namespace orb360::nn {
namespace {

constexpr int kHeight = 64;
constexpr int kWidth = 256;

struct Result {
  Result()
      : x({{1, kHeight, kWidth}, Layout::kPlanar, DataType::kFloat, 0}),
        c({{1, kHeight, kWidth}, Layout::kPlanar, DataType::kFloat, 0}),
        median({{1, 1, 1}, Layout::kPlanar, DataType::kFloat, 0}) {}
  TensorMemory x;
  TensorMemory c;
  TensorMemory median;
};

// Log depth over the median from a sparse depth in any unit.
void Complete(const PlainImage& depth, const PlainImage& confidence, Padding padding, int threads,
              Result& result) {
  const FilledTensor depths(depth, Layout::kPlanar, 0);
  const FilledTensor confidences(confidence, Layout::kPlanar, 0);
  Result sparse;
  MedianLog(depths.view, confidences.view, sparse.x.view, sparse.c.view, result.median.view,
            threads);
  SevenLevelNetwork(padding, kHeight, kWidth, threads)
      .Run({sparse.x.view, sparse.c.view}, {result.x.view, result.c.view});
}

PlainImage Rolled(const PlainImage& image, int columns) {
  PlainImage rolled(image.shape);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      rolled.at(0, v, (u + columns) % kWidth) = image.at(0, v, u);
    }
  }
  return rolled;
}

PlainImage Image(const TensorView& tensor) {
  PlainImage image(tensor.shape);
  for (int v = 0; v < tensor.shape.height; ++v) {
    for (int u = 0; u < tensor.shape.width; ++u) image.at(0, v, u) = At(tensor, 0, v, u);
  }
  return image;
}

PlainImage SparseDepth() { return RandomImage({1, kHeight, kWidth}, 1.0f, 80.0f, 1); }

// One pixel in fifty is known.
PlainImage SparseConfidence() {
  PlainImage c = RandomImage({1, kHeight, kWidth}, -49.0f, 1.0f, 2);
  for (double& value : c.values) value = std::max(value, 0.0);
  return c;
}

// Pixels keep their place on every level when the camera turns by a multiple of the coarsest one.
TEST(PropagationNetwork, TurnsWithTheCameraBitForBit) {
  ForEachDispatchTarget([] {
    for (const Padding padding : {Padding::kWrapReplicate, Padding::kWrapCrossPole}) {
      Result straight;
      Complete(SparseDepth(), SparseConfidence(), padding, 1, straight);
      for (const int turn : {64, 192}) {
        Result turned;
        Complete(Rolled(SparseDepth(), turn), Rolled(SparseConfidence(), turn), padding, 2, turned);
        ExpectEqual(turned.x.view, Rolled(Image(straight.x.view), turn));
        ExpectEqual(turned.c.view, Rolled(Image(straight.c.view), turn));
      }
    }
  });
}

// A map in another unit gives the same log depth over its median. The median and the ratios are
// rounded once each; where the unit is a power of two, nothing is.
TEST(PropagationNetwork, GivesTheSameInEveryUnitOfDepth) {
  ForEachDispatchTarget([] {
    Result metres;
    Complete(SparseDepth(), SparseConfidence(), Padding::kWrapReplicate, 1, metres);
    for (const float unit : {0.25f, 0.1f, 37.0f}) {
      PlainImage depth = SparseDepth();
      for (double& value : depth.values) value = static_cast<float>(value * unit);
      Result scaled;
      Complete(depth, SparseConfidence(), Padding::kWrapReplicate, 1, scaled);
      ExpectSameBits(scaled.c.view, metres.c.view);
      PlainImage tolerance(depth.shape);
      if (unit != 0.25f) {
        // Means of logarithms that are off by two roundings of a ratio, in 14 layers that round
        // the sum of 50 terms of up to 5 each.
        for (double& value : tolerance.values) value = (4 + 14 * 2 * 54 * 5) * 0x1p-24;
      }
      ExpectNear(scaled.x.view, Image(metres.x.view), tolerance);
    }
  });
}

// With points in sight every pixel has a depth, from a map as sparse as SLAM's as well.
TEST(PropagationNetwork, ReachesEveryPixelFromOnePoint) {
  PlainImage depth({1, kHeight, kWidth});
  PlainImage confidence({1, kHeight, kWidth});
  depth.at(0, 40, 7) = 3;
  confidence.at(0, 40, 7) = 0.5;
  Result result;
  Complete(depth, confidence, Padding::kWrapReplicate, 1, result);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      EXPECT_GT(At(result.c.view, 0, v, u), 0) << v << ' ' << u;
      EXPECT_TRUE(std::isfinite(At(result.x.view, 0, v, u))) << v << ' ' << u;
    }
  }
}

}  // namespace
}  // namespace orb360::nn
