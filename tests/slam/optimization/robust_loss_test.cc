#include "slam/optimization/robust_loss.h"

#include <ceres/loss_function.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

void ExpectSame(const RobustLoss& loss, const ceres::LossFunction& reference) {
  for (const double s : {0.0, 1e-12, 0.3, 0.999, 1.0, 1.001, 4.0, 5.99, 6.01, 1e4, 1e300}) {
    double rho[3];
    reference.Evaluate(s, rho);
    EXPECT_EQ(loss(s).rho, rho[0]) << s;
    EXPECT_EQ(loss(s).slope, rho[1]) << s;
  }
}

TEST(RobustLoss, GivesTheValuesOfCeresBitForBit) {
  for (const double scale : {1.0, 2.0, 2.448}) {
    ExpectSame({RobustLoss::kHuber, scale}, ceres::HuberLoss(scale));
    ExpectSame({RobustLoss::kCauchy, scale}, ceres::CauchyLoss(scale));
    ExpectSame({RobustLoss::kArctan, scale}, ceres::ArctanLoss(scale));
  }
  ExpectSame({}, ceres::TrivialLoss());
}

TEST(RobustLoss, ItsSlopeIsTheDerivativeOfItsValue) {
  for (const auto kind :
       {RobustLoss::kTrivial, RobustLoss::kHuber, RobustLoss::kCauchy, RobustLoss::kArctan}) {
    const RobustLoss loss{kind, 1.5};
    for (const double s : {0.1, 1.0, 2.0, 3.0, 30.0}) {
      const double step = 1e-5 * s;
      EXPECT_NEAR((loss(s + step).rho - loss(s - step).rho) / (2 * step), loss(s).slope, 1e-8);
    }
  }
}

}  // namespace
}  // namespace orb360
