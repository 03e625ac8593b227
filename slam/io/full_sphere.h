#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace orb360 {

/// How far a full sphere's width may be from twice its height, relative to that. Encoders round
/// each side to a multiple of up to 16 pixels, 3 % of 512 rows; the nearest perspective format,
/// 4096x2160 of digital cinema, is 5 % away.
inline constexpr double kFullSphereTolerance = 0.03;

/// True when a picture of this size can be an equirectangular full sphere, perhaps stretched a
/// little.
bool IsFullSphere(cv::Size size);

/// Throws UserError, beginning with `name`, unless IsFullSphere(size).
void RequireFullSphere(const std::string& name, cv::Size size);

/// "1024x512".
std::string ToString(cv::Size size);

}  // namespace orb360
