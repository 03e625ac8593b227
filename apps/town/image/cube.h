#pragma once

#include <array>
#include <string_view>

#include <Eigen/Geometry>

namespace orb360::town {

/// The six square images, 90 degrees wide and high, that together show the whole sphere. Each is
/// taken by a camera that looks along -x, with y to the right and z up, in its own frame; the frame
/// of `front` is that of the panorama. `right`, `back` and `left` are turned about the vertical.
/// `up` and `down` are pitched from `front`, so that the lower side of `up` and the upper side of
/// `down` join it.
enum CubeFace { kFront, kRight, kBack, kLeft, kUp, kDown };
inline constexpr int kCubeFaces = 6;
inline constexpr std::array<std::string_view, kCubeFaces> kCubeFaceNames = {
    "front", "right", "back", "left", "up", "down"};

/// Returns camera_from_face, between the frames of the panorama and of a face.
Eigen::Quaterniond CameraFromFace(int face);

/// A point on the cube: the face, and the distances from the middle of its image to the right and
/// upward, in [-1, 1] at the borders.
struct CubePoint {
  int face;
  double right;
  double up;
};

/// Returns the point at which a direction in the panorama's frame, of any length but 0, meets the
/// cube.
CubePoint MeetCube(const Eigen::Vector3d& direction);

}  // namespace orb360::town
