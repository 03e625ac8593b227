#include "apps/town/import/camera_path.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>

#include "slam/io/atomic_file.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Returns true if the first line with data has four numbers.
bool HasPositionsOnly(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string text;
  while (std::getline(stream, text)) {
    std::istringstream line(text.substr(0, text.find('#')));
    double number;
    int count = 0;
    while (line >> number) ++count;
    if (count > 0) return count == 4;
  }
  return false;
}

}  // namespace

CameraPath::CameraPath(std::vector<StampedPose> knots) : knots_(std::move(knots)) {
  ORB360_CHECK(knots_.size() >= 2, knots_.size());
}

Eigen::Vector3d CameraPath::Velocity(size_t knot) const {
  const auto step = [&](size_t k) { return knots_[k + 1].timestamp - knots_[k].timestamp; };
  const auto slope = [&](size_t k) -> Eigen::Vector3d {
    return (knots_[k + 1].world_from_camera.translation - knots_[k].world_from_camera.translation) /
           step(k);
  };
  if (knot == 0) return slope(0);
  if (knot + 1 == knots_.size()) return slope(knot - 1);
  return (step(knot) * slope(knot - 1) + step(knot - 1) * slope(knot)) /
         (step(knot - 1) + step(knot));
}

Rigid3 CameraPath::At(double time) const {
  time = std::clamp(time, begin(), end());
  const auto above =
      std::upper_bound(knots_.begin() + 1, knots_.end() - 1, time,
                       [](double t, const StampedPose& knot) { return t < knot.timestamp; });
  const auto i = static_cast<size_t>(above - knots_.begin());
  const StampedPose& a = knots_[i - 1];
  const StampedPose& b = knots_[i];
  const double duration = b.timestamp - a.timestamp;
  const double t = (time - a.timestamp) / duration;
  const double s = 1 - t;
  const Rigid3& pa = a.world_from_camera;
  const Rigid3& pb = b.world_from_camera;
  return {pa.rotation.slerp(t, pb.rotation),
          s * s * (1 + 2 * t) * pa.translation + t * t * (1 + 2 * s) * pb.translation +
              duration * s * t * (s * Velocity(i - 1) - t * Velocity(i))};
}

void WriteCameraPath(const std::vector<double>& times,
                     const std::vector<Eigen::Vector3d>& positions,
                     const std::filesystem::path& file) {
  ORB360_CHECK(times.size() == positions.size(), times.size());
  std::ostringstream text;
  text << "# time x y z; z up, metres, seconds\n" << std::fixed;
  for (size_t i = 0; i < times.size(); ++i) {
    const Eigen::Vector3d& p = positions[i];
    text << std::setprecision(6) << times[i] << std::setprecision(3) << ' ' << p.x() << ' ' << p.y()
         << ' ' << p.z() << '\n';
  }
  WriteFileAtomically(file, text.str());
}

std::vector<StampedPose> LookAhead(const std::vector<double>& times,
                                   const std::vector<Eigen::Vector3d>& positions) {
  const auto heading_at = [&](size_t i) -> std::optional<double> {
    const Eigen::Vector3d way =
        positions[std::min(i + 1, positions.size() - 1)] - positions[i == 0 ? 0 : i - 1];
    if (way.head<2>().norm() <= 1e-6) return std::nullopt;
    return std::atan2(way.y(), way.x());
  };
  std::optional<double> first;
  for (size_t i = 0; i < positions.size() && !first; ++i) first = heading_at(i);
  double heading = first.value_or(0);
  std::vector<StampedPose> poses;
  for (size_t i = 0; i < positions.size(); ++i) {
    heading = heading_at(i).value_or(heading);
    // A level camera that looks along world +x: camera (-X, +Y, +Z) is world (+x, -y, +z).
    const Eigen::Quaterniond rotation(
        Eigen::AngleAxisd(heading + std::numbers::pi, Eigen::Vector3d::UnitZ()));
    poses.push_back({times[i], {rotation, positions[i]}});
  }
  return poses;
}

CameraPath ReadCameraPath(const std::filesystem::path& file) {
  std::vector<StampedPose> poses;
  const auto require_later = [&](double before, double time, const std::string& where) {
    if (time <= before) throw UserError(where + ": times must increase");
  };
  if (!HasPositionsOnly(file)) {
    poses = ReadTrajectory(file);
    for (size_t i = 1; i < poses.size(); ++i)
      require_later(poses[i - 1].timestamp, poses[i].timestamp,
                    file.string() + ": pose " + std::to_string(i + 1));
  } else {
    std::ifstream stream(file);
    std::vector<double> times;
    std::vector<Eigen::Vector3d> positions;
    std::string text;
    for (int number = 1; std::getline(stream, text); ++number) {
      std::istringstream line(text.substr(0, text.find('#')));
      if ((line >> std::ws).eof()) continue;
      const std::string where = file.string() + ": line " + std::to_string(number);
      double time;
      Eigen::Vector3d p;
      if (!(line >> time >> p.x() >> p.y() >> p.z()) || !(line >> std::ws).eof() ||
          !std::isfinite(time) || !p.allFinite())
        throw UserError(where + ": expected four numbers: time x y z");
      if (!times.empty()) require_later(times.back(), time, where);
      times.push_back(time);
      positions.push_back(p);
    }
    poses = LookAhead(times, positions);
  }
  if (poses.size() < 2) throw UserError(file.string() + ": a path has at least two places");
  return CameraPath(std::move(poses));
}

bool IsFree(const RayScene& scene, const Vector3f& from, const Vector3f& to) {
  // The ray is slightly longer, so that a surface exactly at the end of a step is hit.
  constexpr float kFar = 1.01F;
  const Vector3f step = to - from;
  return step.norm() < 1e-6F || DistanceAlong(scene, from, step, kFar) >= kFar;
}

void RequireFreePath(const RayScene& scene, const CameraPath& path, double end) {
  constexpr double kStep = 0.05;  // seconds
  Vector3f from = path.At(path.begin()).translation.cast<float>();
  double time = path.begin();
  while (time < end) {
    const Vector3f to = path.At(std::min(time + kStep, end)).translation.cast<float>();
    if (!IsFree(scene, from, to)) {
      std::ostringstream message;
      message << "the path goes through a surface at time " << time << ", near (" << from.x()
              << ", " << from.y() << ", " << from.z()
              << "): change the path, or its unit or axes (see --scale and --up)";
      throw UserError(message.str());
    }
    from = to;
    time += kStep;
  }
}

std::optional<double> HeightAboveGround(const RayScene& scene,
                                        const std::vector<Rigid3>& world_from_camera) {
  constexpr float kFar = 100;         // metres
  constexpr double kTolerance = 0.1;  // of the median, for nine places in ten
  std::vector<double> heights;
  heights.reserve(world_from_camera.size());
  for (const Rigid3& pose : world_from_camera) {
    heights.push_back(
        DistanceAlong(scene, pose.translation.cast<float>(), -Vector3f::UnitZ(), kFar));
  }
  std::sort(heights.begin(), heights.end());
  const double median = heights[heights.size() / 2];
  const double low = heights[heights.size() / 20];
  const double high = heights[heights.size() - 1 - heights.size() / 20];
  if (high > median * (1 + kTolerance) || low < median * (1 - kTolerance)) return std::nullopt;
  return median;
}

}  // namespace orb360::town
