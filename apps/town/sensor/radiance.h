#pragma once

#include <functional>

#include <opencv2/core.hpp>

namespace orb360::town {

/// The panorama of linear radiance (blue, green, red) at a time in seconds.
using RadianceAt = std::function<cv::Mat3f(double seconds)>;

}  // namespace orb360::town
