#pragma once

#include <optional>
#include <span>

#include "slam/evaluation/local_scale.h"
#include "slam/io/scale_file.h"

namespace orb360 {

/// How well the standard deviations that a run states of its scale along the path fit its errors:
/// ln(true ratio / stated scale) of each window of the local scale, divided by the stated standard
/// deviation. Neighbouring windows are not independent, so that one recording says little.
struct ScaleCalibration {
  int windows = 0;                      ///< Number of windows with a stated scale.
  double normalized_squared_error = 0;  ///< Mean square; 1 is perfect, more is overconfident.
  double within_1_sigma = 0;            ///< Fraction; 0.68 is perfect.
  double within_2_sigma = 0;            ///< Fraction; 0.95 is perfect.
  double largest = 0;                   ///< Largest error, standard deviations.
};

/// `stated` is ordered by time. A window's stated scale and its standard deviation are the means of
/// those at times within it, or else those of the nearest time. Empty without any.
std::optional<ScaleCalibration> CalibrateScale(const LocalScale& scale,
                                               std::span<const StampedScale> stated);

}  // namespace orb360
