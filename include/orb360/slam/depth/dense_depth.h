#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <opencv2/core.hpp>

namespace orb360 {

/// How the range of a pixel is known.
enum class RangeSource : std::uint8_t {
  kNetwork = 0,       ///< By the network, in a run without stereo; or there is no range.
  kMeasured = 1,      ///< By multi-view stereo.
  kCompleted = 2,     ///< By the network, from landmarks and from what stereo measured.
  kBoundary = 3,      ///< Beside the edge of a near surface, whose range it may have in its place.
  kMovingObject = 4,  ///< Of an object that moves, put upright where it touches the ground.
};

/// All of them.
inline constexpr std::array kRangeSources = {RangeSource::kNetwork, RangeSource::kMeasured,
                                             RangeSource::kCompleted, RangeSource::kBoundary,
                                             RangeSource::kMovingObject};

/// Dense depth of a frame: equirectangular images of one size.
struct DenseDepth {
  /// CV_32FC1: range along each pixel's ray, in the unit of the map; 0 where unknown.
  cv::Mat range;
  /// CV_32FC1 in 0..1: 1 / confidence - 1 is the expected relative error of the range. Of what is
  /// at rest, leave kBoundary and kMovingObject of `source` out: their errors are of another kind.
  cv::Mat confidence;
  /// CV_8UC3, BGR.
  cv::Mat color;
  /// CV_8UC1 of RangeSource. Empty: kNetwork everywhere.
  cv::Mat source = {};
  /// CV_32FC1 in 0..1: probability that a pixel shows the ground over which the camera moves. Empty
  /// if the network does not give it.
  cv::Mat ground = {};
  /// ln of the camera's height over that ground, in the same unit, as the network estimates it from
  /// the whole image, if it does.
  std::optional<double> log_camera_height = {};
};

}  // namespace orb360
