#include "slam/io/lenses/eac.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace orb360 {
namespace {

/// A face: the directions of its columns, rows and centre in the camera frame (-X forward, +Y
/// right, +Z up) as it is stored, its track, and its place from the left.
struct Face {
  Eigen::Vector3d right;
  Eigen::Vector3d down;
  Eigen::Vector3d center;
  int track;
  int place;
};

const std::array<Face, 6>& Faces() {
  const Eigen::Vector3d forward = -Eigen::Vector3d::UnitX();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  static const std::array<Face, 6> faces = {{{forward, -up, -right, 0, 0},
                                             {right, -up, forward, 0, 1},
                                             {-forward, -up, right, 0, 2},
                                             {-forward, -right, -up, 1, 0},
                                             {up, -right, -forward, 1, 1},
                                             {forward, -right, up, 1, 2}}};
  return faces;
}

/// Column or row in a face for the tangent of the angle from its centre.
double Position(double tangent, int face) {
  return face * (0.5 + std::atan(tangent) * 2.0 / std::numbers::pi);
}

}  // namespace

std::optional<EacLayout> EacLayoutOf(cv::Size track) {
  // The overlap is 16 or 32 columns; a larger one would be another layout.
  constexpr int kMaxOverlapOfFace = 16;  // face / overlap, at least
  const int inserted = track.width - 3 * track.height;
  if (track.height <= 0 || track.height % 2 != 0 || inserted <= 0 || inserted % 4 != 0) {
    return std::nullopt;
  }
  const EacLayout layout{track.height, inserted / 4};
  if (layout.overlap * kMaxOverlapOfFace > layout.face) return std::nullopt;
  return layout;
}

StitchSampler EacSampler(const EacLayout& layout) {
  return [layout](const Eigen::Vector3d& bearing, std::vector<StitchSample>* samples) {
    const Face& face = *std::ranges::max_element(
        Faces(), {}, [&](const Face& each) { return each.center.dot(bearing); });
    const double range = face.center.dot(bearing);
    const double u = Position(face.right.dot(bearing) / range, layout.face);
    const double v = Position(face.down.dot(bearing) / range, layout.face);
    if (face.place == 1) {
      samples->push_back({face.track, layout.face + 2.0 * layout.overlap + u, v, 1.0});
      return;
    }
    const double first_column = face.place == 0 ? 0.0 : 2.0 * (layout.face + layout.overlap);
    // From 0 to 1 where both lenses show the direction.
    const double second =
        std::clamp((u - 0.5 * layout.face + layout.overlap) / (2.0 * layout.overlap), 0.0, 1.0);
    if (second < 1.0) samples->push_back({face.track, first_column + u, v, 1.0 - second});
    if (second > 0.0) {
      samples->push_back({face.track, first_column + u + 2.0 * layout.overlap, v, second});
    }
  };
}

}  // namespace orb360
