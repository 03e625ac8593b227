#pragma once

#include <array>
#include <cstdint>

#include <opencv2/core.hpp>

#include "apps/town/image/cube.h"
#include <orb360/slam/geometry/camera.h>

namespace orb360::town {

/// Images of the faces, indexed by CubeFace; square and of one size.
template <typename Pixel>
using CubeImages = std::array<cv::Mat_<Pixel>, kCubeFaces>;

/// Stitches the panorama of six images: the mean of bilinear samples across the borders of the
/// faces, four per pixel, or more if the faces have a higher resolution.
cv::Mat3b StitchColour(const CubeImages<cv::Vec3b>& faces, const EquirectangularCamera& camera);
cv::Mat3f StitchRadiance(const CubeImages<cv::Vec3f>& faces, const EquirectangularCamera& camera);

/// Returns the range along the panorama's rays, metres, from depth along each face's optical axis
/// (z, metres; 0 where there is none; faces of 3 pixels or more). It is the range of the nearest
/// sample, moved along the sample's own surface: 1/z is linear over a plane, and its slope is taken
/// from the side on which it changes less. Planes are therefore exact, and surfaces are never
/// blended.
cv::Mat1f StitchRange(const CubeImages<float>& depth, const EquirectangularCamera& camera);

/// Returns the numbers of the objects that the panorama's rays meet: those of the nearest pixels.
cv::Mat1w StitchObjects(const CubeImages<uint16_t>& objects, const EquirectangularCamera& camera);

/// Decodes depth along the optical axis, metres, from the 24-bit encoding of driving simulators:
/// red is the lowest byte, blue the highest, and the largest number stands for `farthest` metres,
/// which means that nothing was hit. `image` is 8-bit with three or four channels, blue first.
cv::Mat1f DecodeDepth24(const cv::Mat& image, double farthest);

}  // namespace orb360::town
