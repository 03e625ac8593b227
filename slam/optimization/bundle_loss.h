#pragma once

#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/robust_loss.h"

namespace orb360 {

/// The loss of directions. BundleLoss tells the reasons.
constexpr RobustLoss DirectionLoss(BundleLoss loss) {
  constexpr double kHuberSigmas = 1.0;
  constexpr double kArctanSquares = 2.0;  // squared sigmas at which the cost is half of its limit
  return loss == BundleLoss::kArctan ? RobustLoss{RobustLoss::kArctan, kArctanSquares}
                                     : RobustLoss{RobustLoss::kHuber, kHuberSigmas};
}

/// The loss of heights. They are weighted robustly where their plane is fitted (GroundPlane).
constexpr RobustLoss HeightLoss() { return {}; }

/// The loss of ranges that are known roughly. Networks are wrong altogether more often than corners
/// are, and a range that is wrong by far should not count at all.
constexpr RobustLoss RangeLoss() { return {RobustLoss::kCauchy, 1.0}; }

/// The loss of points that two cameras see. Each is the agreement of many tiles of the ground, so
/// it overrules landmarks that contradict it, as those on a car beside the camera do.
constexpr RobustLoss SharedPointLoss() { return {}; }

}  // namespace orb360
