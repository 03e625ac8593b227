#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

namespace orb360::town {

/// Returns the baked light at a place of a page (see kLightPageSide), interpolated bilinearly
/// between the centres of pixels: red, green and blue, 0 to 255. `uv` is in [0, 1], v downward.
Eigen::Vector3f SampleLightPage(std::span<const uint8_t> page, const Eigen::Vector2f& uv);

/// Returns the linear factor on a linear texture that baked light of 0 to 255 is.
///
/// Quake multiplies the light with the texture as they are stored, without any gamma, and shows
/// four times the product (two overbright bits), where no channel of the light may exceed twice
/// the texture: brighter light keeps its hue. A display raises what it is sent to the power of 2.2,
/// and so does this function: the power of a product is the product of the powers.
Eigen::Vector3f QuakeIrradiance(const Eigen::Vector3f& light);

}  // namespace orb360::town
