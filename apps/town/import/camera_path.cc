#include "apps/town/import/camera_path.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>

#include "slam/check.h"

namespace orb360::town {
namespace {

/// Whether the first line that says something has four numbers.
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

/// The distance to the nearest surface in a direction of any length, in units of that length; at
/// most `far`.
float DistanceAlong(const RayScene& scene, const Vector3f& origin, const Vector3f& direction,
                    float far) {
  RTCRayHit16 rays;
  alignas(64) std::array<int, kPacket> valid{};
  valid[0] = -1;
  SetRay(rays.ray, 0, origin, direction, far);
  rays.hit.geomID[0] = RTC_INVALID_GEOMETRY_ID;
  scene.Intersect(valid.data(), &rays);
  return rays.ray.tfar[0];
}

}  // namespace

CameraPath::CameraPath(std::vector<StampedPose> knots) : knots_(std::move(knots)) {
  ORB360_CHECK(knots_.size() >= 2, knots_.size());
}

Eigen::Vector3d CameraPath::Velocity(size_t knot) const {
  const StampedPose& before = knots_[knot == 0 ? 0 : knot - 1];
  const StampedPose& after = knots_[std::min(knot + 1, knots_.size() - 1)];
  return (after.world_from_camera.translation - before.world_from_camera.translation) /
         (after.timestamp - before.timestamp);
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

std::vector<StampedPose> LookAhead(const std::vector<double>& times,
                                   const std::vector<Eigen::Vector3d>& positions) {
  std::vector<StampedPose> poses;
  double heading = 0;
  for (size_t i = 0; i < positions.size(); ++i) {
    const Eigen::Vector3d way =
        positions[std::min(i + 1, positions.size() - 1)] - positions[i == 0 ? 0 : i - 1];
    if (way.head<2>().norm() > 1e-6) heading = std::atan2(way.y(), way.x());
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

void RequireFreePath(const RayScene& scene, const std::vector<Rigid3>& world_from_camera) {
  for (size_t i = 1; i < world_from_camera.size(); ++i) {
    const Vector3f from = world_from_camera[i - 1].translation.cast<float>();
    const Vector3f step = world_from_camera[i].translation.cast<float>() - from;
    // A little farther, so that a surface right where a frame is taken is met.
    constexpr float kFar = 1.01F;
    if (step.norm() < 1e-6F || DistanceAlong(scene, from, step, kFar) >= kFar) continue;
    std::ostringstream message;
    message << "the path goes through a surface between frames " << i - 1 << " and " << i
            << ", at (" << from.x() << ", " << from.y() << ", " << from.z()
            << "): change the path, or its unit or axes (see --scale and --up)";
    throw UserError(message.str());
  }
}

std::optional<double> HeightAboveGround(const RayScene& scene,
                                        const std::vector<Rigid3>& world_from_camera) {
  constexpr float kFar = 100;         // metres
  constexpr double kTolerance = 0.1;  // of the median, for nine places in ten
  std::vector<double> heights;
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
