#include "nn/kernels/median_log.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kSmallest = std::numeric_limits<float>::denorm_min();

struct Result {
  explicit Result(const Shape& shape)
      : x({shape, Layout::kPlanar, DataType::kFloat, 0}),
        c({shape, Layout::kPlanar, DataType::kFloat, 2}),
        median({{1, 1, 1}, Layout::kPlanar, DataType::kFloat, 0}) {}
  float s() const { return *median.view.row<float>(0, 0); }
  TensorMemory x;
  TensorMemory c;
  TensorMemory median;
};

void RunMedianLog(const PlainImage& depth, const PlainImage& confidence, int threads,
                  Result& result) {
  const FilledTensor depths(depth, Layout::kPlanar, 0);
  const FilledTensor confidences(confidence, Layout::kPlanar, 1);
  MedianLog(depths.view, confidences.view, result.x.view, result.c.view, result.median.view,
            threads);
}

void ExpectAsExpected(const PlainImage& depth, const PlainImage& confidence) {
  ForEachDispatchTarget([&] {
    std::vector<double> points;
    const auto is_point = [&](std::size_t i) {
      return std::isfinite(depth.values[i]) && depth.values[i] > 0 && confidence.values[i] > 0;
    };
    for (std::size_t i = 0; i < depth.values.size(); ++i) {
      if (is_point(i)) points.push_back(depth.values[i]);
    }
    std::sort(points.begin(), points.end());
    const double s = points.empty() ? 1 : points[(points.size() - 1) / 2];
    PlainImage x(depth.shape);
    PlainImage c(depth.shape);
    PlainImage tolerance(depth.shape);
    for (std::size_t i = 0; i < depth.values.size(); ++i) {
      if (!is_point(i)) continue;
      x.values[i] = std::log(depth.values[i] / s);
      c.values[i] = std::min(confidence.values[i], 1.0);
      tolerance.values[i] = 1.01 * 0x1p-24 * std::abs(x.values[i]);
    }
    Result one(depth.shape);
    Result two(depth.shape);
    RunMedianLog(depth, confidence, 1, one);
    RunMedianLog(depth, confidence, 2, two);
    EXPECT_EQ(one.s(), s);
    ExpectNear(one.x.view, x, tolerance);
    ExpectEqual(one.c.view, c);
    EXPECT_EQ(two.s(), s);
    ExpectSameBits(one.x.view, two.x.view);
    ExpectSameBits(one.c.view, two.c.view);
  });
}

TEST(MedianLog, IsTheLogarithmOfDepthOverTheLowerMedian) {
  for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 2}, {7, 9}, {64, 129}}) {
    for (const float known : {0.02f, 0.5f, 1.0f}) {
      PlainImage depth = RandomImage({1, rows, columns}, 0.5f, 80.0f, 1);
      PlainImage confidence = RandomImage({1, rows, columns}, known - 1, known, 2);
      // Also confidences above 1, and depths where nothing is known.
      for (double& value : confidence.values) value = static_cast<float>(3 * value);
      ExpectAsExpected(depth, confidence);
    }
  }
}

TEST(MedianLog, FindsTheMedianOfDepthsThatDifferInTheirLastBitOnly) {
  PlainImage depth({1, 3, 101});
  PlainImage confidence({1, 3, 101});
  for (int i = 0; i < 303; ++i) {
    depth.values[i] = 1 + (i * 37 % 303) * 0x1p-23;
    confidence.values[i] = 1;
  }
  ExpectAsExpected(depth, confidence);
}

TEST(MedianLog, TakesTheLowerOneOfTwo) {
  PlainImage depth({1, 1, 4});
  depth.values = {8, 0, 2, 4};
  PlainImage confidence({1, 1, 4});
  confidence.values = {0, 1, 1, 1};
  Result result(depth.shape);
  RunMedianLog(depth, confidence, 1, result);
  EXPECT_EQ(result.s(), 2);
}

TEST(MedianLog, IsOneWhereThereAreNoPoints) {
  PlainImage depth({1, 2, 3});
  depth.values = {1, 2, 0, -1, kNan, kInfinity};
  PlainImage confidence({1, 2, 3});
  confidence.values = {0, kNan, 1, 1, 1, 1};
  Result result(depth.shape);
  RunMedianLog(depth, confidence, 1, result);
  EXPECT_EQ(result.s(), 1);
  ExpectEqual(result.x.view, PlainImage(depth.shape));
  ExpectEqual(result.c.view, PlainImage(depth.shape));
}

TEST(MedianLog, EndsWhatIsNotFiniteWhateverTheScale) {
  PlainImage depth({1, 1, 9});
  depth.values = {kLargest, kSmallest, kSmallest, kNan, kInfinity, -kInfinity, 1, 1e-30f, 2};
  PlainImage confidence({1, 1, 9});
  confidence.values = {1, kInfinity, kSmallest, 1, 1, 1, -1, 0.5f, kNan};
  ExpectAsExpected(depth, confidence);
}

TEST(MedianLog, IsExactlyTheSameForDepthsInUnitsOfAPowerOfTwo) {
  PlainImage depth = RandomImage({1, 20, 30}, 0.5f, 80.0f, 1);
  const PlainImage confidence = RandomImage({1, 20, 30}, -0.9f, 1.0f, 2);
  Result metres(depth.shape);
  RunMedianLog(depth, confidence, 1, metres);
  for (double& value : depth.values) value /= 64;
  Result other(depth.shape);
  RunMedianLog(depth, confidence, 1, other);
  EXPECT_EQ(other.s(), metres.s() / 64);
  ExpectSameBits(other.x.view, metres.x.view);
}

TEST(MedianLog, RefusesShapesThatDoNotFit) {
  const TensorMemory one({{1, 3, 4}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory wide({{1, 3, 5}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory median({{1, 1, 1}, Layout::kPlanar, DataType::kFloat, 0});
  EXPECT_THROW(MedianLog(one.view, wide.view, one.view, one.view, median.view, 1), ContractError);
  EXPECT_THROW(MedianLog(one.view, one.view, one.view, one.view, one.view, 1), ContractError);
}

}  // namespace
}  // namespace orb360::nn
