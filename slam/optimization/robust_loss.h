#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace orb360 {

/// A robust loss rho of the squared residual s, with rho(s) ~ s for small s. The losses and their
/// scale are those that Ceres defines (ceres/loss_function.h), in the same arithmetic.
struct RobustLoss {
  enum Kind {
    kTrivial,  ///< rho(s) = s
    kHuber,    ///< s, from `scale` on 2 scale sqrt(s) - scale^2
    kCauchy,   ///< scale^2 log(1 + s / scale^2)
    kArctan,   ///< scale atan(s / scale)
  };
  struct Value {
    double rho;
    /// rho'(s), positive: the weight of the residual in iteratively reweighted least squares.
    double slope;
  };

  Kind kind = kTrivial;
  /// In units of the residual; for kArctan in units of its square.
  double scale = 1.0;

  Value operator()(double s) const {
    constexpr double kMinSlope = std::numeric_limits<double>::min();
    switch (kind) {
      case kTrivial:
        break;
      case kHuber: {
        const double squared_scale = scale * scale;
        if (s <= squared_scale) break;
        const double residual = std::sqrt(s);
        return {2.0 * scale * residual - squared_scale, std::max(kMinSlope, scale / residual)};
      }
      case kCauchy: {
        const double squared_scale = scale * scale;
        const double sum = 1.0 + s * (1.0 / squared_scale);
        return {squared_scale * std::log(sum), std::max(kMinSlope, 1.0 / sum)};
      }
      case kArctan: {
        const double sum = 1.0 + s * s * (1.0 / (scale * scale));
        return {scale * std::atan2(s, scale), std::max(kMinSlope, 1.0 / sum)};
      }
    }
    return {s, 1.0};
  }
};

}  // namespace orb360
