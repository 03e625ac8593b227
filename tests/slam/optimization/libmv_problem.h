#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slam/optimization/bundle_problem.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

/// Reads the little-endian binary format of libmv's bundle adjustment problems: one byte "v", one
/// byte for the unit of markers, then 4-byte floats and integers.
class LibmvReader {
 public:
  explicit LibmvReader(const std::filesystem::path& file) : name_(file.string()) {
    std::ifstream stream(file, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
    if (bytes_.size() < 2 || bytes_[0] != 'v' || std::endian::native != std::endian::little) {
      throw UserError(name_ + ": not a little-endian libmv problem");
    }
    position_ = 2;
  }

  /// True where markers are in pixels, false where they are normalized by the intrinsics.
  bool IsInPixels() const { return bytes_[1] == 'P'; }
  int Integer() { return Read<int32_t>(); }
  double Real() { return Read<float>(); }
  template <typename Matrix>
  Matrix Reals() {
    Matrix matrix;
    for (double& value : matrix.reshaped()) value = Real();
    return matrix;
  }

 private:
  template <typename T>
  T Read() {
    if (position_ + sizeof(T) > bytes_.size()) throw UserError(name_ + ": ends too early");
    T value;
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }

  std::string name_;
  std::string bytes_;
  size_t position_ = 0;
};

/// The intrinsics of a libmv camera, which looks along +z, with Brown's model of distortion.
struct LibmvIntrinsics {
  double focal_length;
  Eigen::Vector2d principal_point;
  double k1, k2, k3, p1, p2;

  /// Distorts a point of the normalized image plane.
  Eigen::Vector2d Distort(const Eigen::Vector2d& p) const {
    const double r2 = p.squaredNorm();
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return {p.x() * radial + 2 * p1 * p.x() * p.y() + p2 * (r2 + 2 * p.x() * p.x()),
            p.y() * radial + 2 * p2 * p.x() * p.y() + p1 * (r2 + 2 * p.y() * p.y())};
  }

  /// Unit bearing of a marker, by fixed-point iteration.
  Eigen::Vector3d Bearing(const Eigen::Vector2d& marker, bool is_in_pixels) const {
    if (!is_in_pixels) return marker.homogeneous().normalized();
    const Eigen::Vector2d distorted = (marker - principal_point) / focal_length;
    Eigen::Vector2d undistorted = distorted;
    for (int i = 0; i < 50; ++i) undistorted += distorted - Distort(undistorted);
    return undistorted.homogeneous().normalized();
  }
};

/// Reads a problem of libmv with bearings in the place of pixels, each with a sigma of one pixel.
/// Its first pose is fixed. Points without markers are left out. Throws UserError for a file that
/// is not such a problem.
inline BundleProblem ReadLibmvProblem(const std::filesystem::path& file) {
  LibmvReader reader(file);
  LibmvIntrinsics intrinsics{};
  intrinsics.focal_length = reader.Real();
  intrinsics.principal_point = reader.Reals<Eigen::Vector2d>();
  for (double* value :
       {&intrinsics.k1, &intrinsics.k2, &intrinsics.k3, &intrinsics.p1, &intrinsics.p2}) {
    *value = reader.Real();
  }
  BundleProblem problem;
  std::map<int, int> pose_of_image;
  for (int left = reader.Integer(); left > 0; --left) {
    const int image = reader.Integer();
    const auto matrix = reader.Reals<Eigen::Matrix3d>();
    const auto translation = reader.Reals<Eigen::Vector3d>();
    pose_of_image[image] = static_cast<int>(problem.world_from_camera.size());
    problem.world_from_camera.push_back(
        Rigid3{Eigen::Quaterniond(matrix).normalized(), translation}.Inverse());
  }
  problem.pose_fixed.assign(problem.world_from_camera.size(), 0);
  problem.pose_fixed.at(0) = 1;
  std::map<int, Eigen::Vector3d> positions;  // by track
  for (int left = reader.Integer(); left > 0; --left) {
    const int track = reader.Integer();
    positions[track] = reader.Reals<Eigen::Vector3d>();
  }
  std::map<int, int> point_of_track;
  for (int left = reader.Integer(); left > 0; --left) {
    const int image = reader.Integer();
    const int track = reader.Integer();
    const auto marker = reader.Reals<Eigen::Vector2d>();
    if (!pose_of_image.contains(image) || !positions.contains(track)) continue;
    const auto [point, is_new] =
        point_of_track.try_emplace(track, static_cast<int>(problem.points.size()));
    if (is_new) problem.points.push_back(positions[track]);
    problem.observations.push_back({.pose = pose_of_image[image],
                                    .point = point->second,
                                    .bearing = intrinsics.Bearing(marker, reader.IsInPixels()),
                                    .sigma = 1.0 / intrinsics.focal_length});
  }
  return problem;
}

/// The names of the problems that Ceres' repository has (data/libmv-ba-problems).
inline constexpr const char* kLibmvProblems[] = {"problem_01.bin", "problem_02.bin",
                                                 "problem_03.bin"};

}  // namespace orb360
