#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace orb360 {

/// Largest relative difference between the width of a full sphere's image and twice its height.
/// Encoders round each side to a multiple of up to 16 pixels, which is 3 % of 512 rows. The nearest
/// perspective format, 4096x2160 of digital cinema, differs by 5 %.
inline constexpr double kFullSphereTolerance = 0.03;

/// Returns true when an image of this size can be an equirectangular full sphere, perhaps slightly
/// stretched.
bool IsFullSphere(cv::Size size);

/// Throws UserError, whose message begins with `name`, unless IsFullSphere(size).
void RequireFullSphere(const std::string& name, cv::Size size);

/// Returns the size as text, such as "1024x512".
std::string ToString(cv::Size size);

}  // namespace orb360
