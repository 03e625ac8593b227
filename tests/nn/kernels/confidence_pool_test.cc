#include "nn/kernels/confidence_pool.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Pooled {
  Pooled(const PlainImage& x, const PlainImage& c, ConfidenceRule rule, int threads)
      : value({{x.shape.channels, x.shape.height / 2, x.shape.width / 2},
               Layout::kPlanar,
               DataType::kFloat,
               0}),
        confidence({value.view.shape, Layout::kPlanar, DataType::kFloat, 0}) {
    const FilledTensor x_tensor(x, Layout::kPlanar, 0);
    const FilledTensor c_tensor(c, Layout::kPlanar, 1);
    ConfidencePool(x_tensor.view, c_tensor.view, value.view, confidence.view, rule, threads);
  }
  TensorMemory value;
  TensorMemory confidence;
};

TEST(ConfidencePool, TakesWhatIsMostConfidentTheFirstAmongEquals) {
  ForEachDispatchTarget([] {
    for (const ConfidenceRule rule : {ConfidenceRule::kQuarter, ConfidenceRule::kSquareRoot}) {
      for (const Shape pooled : {Shape{1, 1, 1}, Shape{2, 3, 5}, Shape{3, 2, 67}}) {
        const Shape shape{pooled.channels, 2 * pooled.height, 2 * pooled.width};
        const PlainImage x = RandomImage(shape, -3.0f, 3.0f, 1);
        PlainImage c = RandomImage(shape, 0.0f, 1.0f, 2);
        // Few levels, zero among them: most squares hold equals.
        for (double& value : c.values) value = std::floor(value * 3) / 4;
        PlainImage value(pooled);
        PlainImage confidence(pooled);
        PlainImage rounding(pooled);
        for (int channel = 0; channel < pooled.channels; ++channel) {
          for (int v = 0; v < pooled.height; ++v) {
            for (int u = 0; u < pooled.width; ++u) {
              int best = 0;
              const auto at = [&](const PlainImage& p, int k) {
                return p.at(channel, 2 * v + k / 2, 2 * u + k % 2);
              };
              for (int k = 1; k < 4; ++k) {
                if (at(c, k) > at(c, best)) best = k;
              }
              value.at(channel, v, u) = at(x, best);
              const double most = at(c, best);
              confidence.at(channel, v, u) =
                  rule == ConfidenceRule::kQuarter ? most / 4 : std::sqrt(most);
              rounding.at(channel, v, u) = std::sqrt(most) * 0x1p-24;
            }
          }
        }
        const Pooled one(x, c, rule, 1);
        const Pooled two(x, c, rule, 2);
        ExpectEqual(one.value.view, value);
        ExpectNear(one.confidence.view, confidence, rounding);
        ExpectSameBits(one.value.view, two.value.view);
        ExpectSameBits(one.confidence.view, two.confidence.view);
      }
    }
  });
}

TEST(ConfidencePool, ComparesAsFloatsDo) {
  ForEachDispatchTarget([] {
    PlainImage x({1, 2, 6});
    PlainImage c({1, 2, 6});
    for (int i = 0; i < 12; ++i) x.values[i] = i;
    // Three squares; in each the four confidences in row-major order.
    const float confidences[3][4] = {
        {kNan, 1, 2, 3}, {0, kNan, 0.25f, kNan}, {0, 1, kInfinity, kNan}};
    for (int square = 0; square < 3; ++square) {
      for (int k = 0; k < 4; ++k) c.at(0, k / 2, 2 * square + k % 2) = confidences[square][k];
    }
    x.at(0, 1, 4) = kNan;
    const Pooled pooled(x, c, ConfidenceRule::kQuarter, 1);
    EXPECT_EQ(At(pooled.value.view, 0, 0, 0), 0);
    EXPECT_TRUE(std::isnan(At(pooled.confidence.view, 0, 0, 0)));
    EXPECT_EQ(At(pooled.value.view, 0, 0, 1), 8);
    EXPECT_EQ(At(pooled.confidence.view, 0, 0, 1), 0.0625f);
    EXPECT_TRUE(std::isnan(At(pooled.value.view, 0, 0, 2)));
    EXPECT_EQ(At(pooled.confidence.view, 0, 0, 2), kInfinity);
  });
}

TEST(ConfidencePool, RefusesOddSizes) {
  const PlainImage odd({1, 3, 4});
  EXPECT_THROW(Pooled(odd, odd, ConfidenceRule::kQuarter, 1), ContractError);
}

}  // namespace
}  // namespace orb360::nn
