#include "slam/scale/scale_measurement.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(FuseScales, WeighsByPrecisionWhereBothAgree) {
  bool is_conflict = true;
  const ScaleMeasurement fused = FuseScales({0.10, 0.04}, {0.05, 0.02}, &is_conflict);
  EXPECT_FALSE(is_conflict);
  EXPECT_NEAR(fused.log_scale, 0.06, 1e-12);
  EXPECT_NEAR(fused.sigma, 0.04 / std::sqrt(5.0), 1e-12);
}

TEST(FuseScales, CoversBothWhereTheyContradictEachOther) {
  bool is_conflict = false;
  const ScaleMeasurement a{0.5, 0.02};
  const ScaleMeasurement b{0.0, 0.05};
  const ScaleMeasurement fused = FuseScales(a, b, &is_conflict);
  EXPECT_TRUE(is_conflict);
  EXPECT_GT(fused.log_scale, b.log_scale);
  EXPECT_LT(fused.log_scale, a.log_scale);
  // The mean square error about the result, whichever is right.
  EXPECT_NEAR(fused.sigma, std::hypot(a.sigma, fused.log_scale - a.log_scale), 1e-12);
  EXPECT_NEAR(fused.sigma, std::hypot(b.sigma, fused.log_scale - b.log_scale), 1e-12);
}

}  // namespace
}  // namespace orb360
