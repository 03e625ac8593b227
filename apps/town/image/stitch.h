#pragma once

#include <array>
#include <cstdint>

#include <opencv2/core.hpp>

#include "apps/town/image/cube.h"
#include "slam/geometry/camera.h"

namespace orb360::town {

/// Pictures of the faces, by CubeFace; square and of one size.
template <typename Pixel>
using CubeImages = std::array<cv::Mat_<Pixel>, kCubeFaces>;

/// The panorama that six pictures show: the mean of bilinear samples, four a pixel or as many more
/// as the faces are finer than it, across the borders of the faces.
cv::Mat3b StitchColour(const CubeImages<cv::Vec3b>& faces, const EquirectangularCamera& camera);
cv::Mat3f StitchRadiance(const CubeImages<cv::Vec3f>& faces, const EquirectangularCamera& camera);

/// The range along the panorama's rays, metres, from depth along each face's optical axis (z,
/// metres; 0 where there is none; faces of 3 pixels or more). It is that of the nearest sample,
/// moved along the sample's own surface: the inverse of z is linear over a plane, and its slope is
/// taken from the side on which it changes less. So planes are exact, and surfaces never blend.
cv::Mat1f StitchRange(const CubeImages<float>& depth, const EquirectangularCamera& camera);

/// The numbers of what the panorama's rays meet: those of the nearest pixels.
cv::Mat1w StitchObjects(const CubeImages<uint16_t>& objects, const EquirectangularCamera& camera);

/// Depth along the optical axis in metres from the 24-bit encoding of driving simulators: red is
/// the lowest byte, blue the highest, and the largest number stands for `farthest` metres, which
/// means nothing was met. `image` is 8-bit with three or four channels, blue first.
cv::Mat1f DecodeDepth24(const cv::Mat& image, double farthest);

}  // namespace orb360::town
