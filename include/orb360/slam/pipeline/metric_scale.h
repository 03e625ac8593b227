#pragma once

#include <optional>
#include <string>
#include <vector>

namespace orb360 {

/// How far the unit of length of a result can be relied on.
enum class ScaleState {
  kUnknown,  ///< The unit is arbitrary, or its standard deviation is larger than 30 %.
  kRough,    ///< Metres with a standard deviation of up to 30 %.
  kMetric    ///< The same of up to 3 %, from a height or from positions that the user gave.
};

/// Name of a state as summary.json has it: "unknown", "rough" or "metric".
const char* ToString(ScaleState state);

/// The least probability of ground below the camera with which the scale follows from it. Of 26
/// recordings the least has 0.58 (docs/results/scale.md); one on its side has 0.20.
inline constexpr double kMinGroundProbability = 0.4;

/// The scale of a result and what is known of its error.
struct MetricScale {
  ScaleState state = ScaleState::kUnknown;  ///< How far metres can be relied on.
  /// Estimated metres in a unit of the result; 0 where nothing tells.
  double value = 0;
  /// Standard deviation of ln(value): of the measurements, their conflicts, and the height of the
  /// camera, which all of them share; 0 where nothing tells.
  double sigma = 0;
  /// Height of the camera over the ground that was used, metres; 0 without one, and where positions
  /// contradict an assumed one.
  double camera_height = 0;
  /// Whether nobody gave that height.
  bool is_height_assumed = false;
  /// Distance between the lens that looks ahead and the one that looks back, as far as stitching
  /// has left it near the ground, metres; 0 where the images show none beyond doubt. It has been
  /// taken out of the steps over the ground.
  double lens_distance = 0;
  /// How far the surroundings rise above the ground, in heights of the camera: 90 % quantile over
  /// the landmarks nearby; 0 where too few tell. An assumed height is as uncertain as that makes
  /// it.
  double surroundings_rise = 0;
  /// How probable the network finds it that what lies below the camera is ground, if it was asked.
  /// With less than kMinGroundProbability, that ground tells no scale: it may be a wall.
  std::optional<double> ground_probability = std::nullopt;
  /// What the scale was measured with, in the order of their weight.
  std::vector<std::string> sources;
};

/// The scale of the path near a keyframe.
struct KeyframeScale {
  int frame = 0;         ///< Index of the keyframe's frame.
  double timestamp = 0;  ///< Seconds.
  int map = 0;           ///< Index into Reconstruction::maps.
  double value = 0;      ///< Estimated metres in a unit of the result; 0 where nothing tells.
  double sigma = 0;      ///< Standard deviation of ln(value); 0 where nothing tells.
};

}  // namespace orb360
