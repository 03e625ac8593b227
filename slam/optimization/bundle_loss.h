#pragma once

#include <memory>

#include <ceres/loss_function.h>

#include "slam/optimization/bundle_adjustment.h"

namespace orb360 {

// The reason is told at BundleLoss.
inline std::unique_ptr<ceres::LossFunction> MakeBearingLoss(BundleLoss loss) {
  constexpr double kHuberSigmas = 1.0;
  constexpr double kArctanSquares = 2.0;  // squared sigmas, where the cost is half of its limit
  if (loss == BundleLoss::kArctan) return std::make_unique<ceres::ArctanLoss>(kArctanSquares);
  return std::make_unique<ceres::HuberLoss>(kHuberSigmas);
}

/// Of ranges that are known roughly: networks are wrong altogether more often than corners are, and
/// what is wrong by far should not count at all. In sigmas.
inline constexpr double kRangeCauchySigmas = 1.0;

}  // namespace orb360
