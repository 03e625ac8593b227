#include "apps/town/sequence/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "slam/features/orb_extractor.h"

namespace orb360::town {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Eigen::Vector3d Forward(const Rigid3& world_from_camera) {
  return world_from_camera.rotation * -Eigen::Vector3d::UnitX();
}

/// Returns the signed angle between the horizontal directions of two cameras, radians.
double Turn(const Rigid3& from, const Rigid3& to) {
  const Eigen::Vector3d a = Forward(from);
  const Eigen::Vector3d b = Forward(to);
  return std::remainder(std::atan2(b.y(), b.x()) - std::atan2(a.y(), a.x()), 2 * std::numbers::pi);
}

void MeasurePath(const Drive& drive, DriveStatistics* s) {
  constexpr double kStanding = 0.2;  // metres per second
  std::vector<Rigid3> poses;
  for (int frame = 0; frame < s->frames; ++frame) poses.push_back(drive.WorldFromCamera(frame));
  double lowest = poses.front().translation.z();
  double highest = lowest;
  int driving = 0;
  std::vector<double> turn_rates;
  for (size_t i = 1; i < poses.size(); ++i) {
    const double step = (poses[i].translation - poses[i - 1].translation).norm();
    s->path_length += step;
    s->maximum_speed = std::max(s->maximum_speed, step * drive.fps());
    driving += step * drive.fps() > kStanding ? 1 : 0;
    const double turn = std::abs(Turn(poses[i - 1], poses[i])) / kDegree;
    s->total_turn += turn;
    turn_rates.push_back(turn * drive.fps());
    lowest = std::min(lowest, poses[i].translation.z());
    highest = std::max(highest, poses[i].translation.z());
  }
  s->climb = highest - lowest;
  if (!turn_rates.empty()) {
    std::sort(turn_rates.begin(), turn_rates.end());
    s->turn_rate_95 = turn_rates[turn_rates.size() * 95 / 100];
    s->maximum_turn_rate = turn_rates.back();
    s->standing_fraction = 1 - driving / static_cast<double>(turn_rates.size());
  }
  if (driving > 0) s->mean_speed = s->path_length * drive.fps() / driving;
  s->revisits = FindRevisits(poses);
}

/// Adds the solid angle of a frame's ranges to the bins, as fractions of the sphere.
void AddRanges(const GeometryImage& geometry, uint16_t first_moving_id, DriveStatistics* s) {
  double sphere = 0;
  for (int row = 0; row < geometry.range.rows; ++row)
    sphere += std::sin(std::numbers::pi * (row + 0.5) / geometry.range.rows);
  for (int row = 0; row < geometry.range.rows; ++row) {
    const double weight = std::sin(std::numbers::pi * (row + 0.5) / geometry.range.rows) /
                          (sphere * geometry.range.cols);
    for (int column = 0; column < geometry.range.cols; ++column) {
      const float range = geometry.range(row, column);
      const auto bin =
          range == 0
              ? kRangeBins.size() + 1
              : static_cast<size_t>(std::lower_bound(kRangeBins.begin(), kRangeBins.end(), range) -
                                    kRangeBins.begin());
      s->range_fractions[bin] += weight;
      if (geometry.object(row, column) >= first_moving_id) s->moving_fraction += weight;
    }
  }
}

}  // namespace

Revisits FindRevisits(std::span<const Rigid3> world_from_camera) {
  constexpr double kNear = 5;   // metres
  constexpr double kAway = 50;  // metres of travel
  const double cosine = std::cos(45 * kDegree);
  std::vector<double> travelled = {0};
  for (size_t i = 1; i < world_from_camera.size(); ++i) {
    travelled.push_back(
        travelled.back() +
        (world_from_camera[i].translation - world_from_camera[i - 1].translation).norm());
  }
  Revisits revisits;
  for (size_t i = 1; i < world_from_camera.size(); ++i) {
    bool same = false;
    bool opposite = false;
    for (size_t j = 0; j < i && travelled[i] - travelled[j] > kAway; ++j) {
      if ((world_from_camera[i].translation - world_from_camera[j].translation).norm() > kNear)
        continue;
      const double agreement = Forward(world_from_camera[i]).dot(Forward(world_from_camera[j]));
      same |= agreement > cosine;
      opposite |= agreement < -cosine;
    }
    const double step = travelled[i] - travelled[i - 1];
    revisits.same_fraction += same ? step : 0;
    revisits.opposite_fraction += opposite ? step : 0;
  }
  if (travelled.back() > 0) {
    revisits.same_fraction /= travelled.back();
    revisits.opposite_fraction /= travelled.back();
  }
  return revisits;
}

DriveStatistics MeasureDrive(const Drive& drive, int every, int sought) {
  DriveStatistics s;
  s.frames = drive.frames();
  s.seconds = (s.frames - 1) / drive.fps();
  MeasurePath(drive, &s);
  OrbExtractor extractor({.num_features = sought});
  s.minimum_corners = sought;
  int images = 0;
  for (int frame = 0; frame < s.frames; frame += every) {
    const FrameScene scene = drive.SceneAt(frame);
    AddRanges(drive.Geometry(scene, frame), scene.first_moving_id(), &s);
    cv::Mat gray;
    cv::cvtColor(drive.Colour(scene, frame), gray, cv::COLOR_BGR2GRAY);
    const auto corners = static_cast<double>(extractor.Extract(gray).keypoints.size());
    s.mean_corners += corners;
    s.minimum_corners = std::min(s.minimum_corners, corners);
    ++images;
  }
  s.mean_corners /= images;
  s.moving_fraction /= images;
  for (double& fraction : s.range_fractions) fraction /= images;
  return s;
}

std::string StatisticsTable(std::span<const std::string> names,
                            std::span<const DriveStatistics> statistics) {
  std::string table = "| |";
  for (const std::string& name : names) table += " " + name + " |";
  table += "\n|---|";
  for (size_t i = 0; i < names.size(); ++i) table += "---:|";
  table += "\n";
  const auto row = [&](const std::string& label, int decimals,
                       const std::function<double(const DriveStatistics&)>& value) {
    table += "| " + label + " |";
    for (const DriveStatistics& s : statistics) {
      char text[64];
      std::snprintf(text, sizeof text, " %.*f |", decimals, value(s));
      table += text;
    }
    table += "\n";
  };
  using S = const DriveStatistics&;
  row("frames", 0, [](S s) { return s.frames; });
  row("duration, s", 0, [](S s) { return s.seconds; });
  row("path, m", 0, [](S s) { return s.path_length; });
  row("mean speed while driving, m/s", 1, [](S s) { return s.mean_speed; });
  row("largest speed, m/s", 1, [](S s) { return s.maximum_speed; });
  row("standing, % of the time", 1, [](S s) { return 100 * s.standing_fraction; });
  row("height between lowest and highest place, m", 1, [](S s) { return s.climb; });
  row("turn rate, 95th percentile, degrees/s", 1, [](S s) { return s.turn_rate_95; });
  row("largest turn rate, degrees/s", 1, [](S s) { return s.maximum_turn_rate; });
  row("turns added up, degrees", 0, [](S s) { return s.total_turn; });
  row("path driven before in the same direction, %", 0,
      [](S s) { return 100 * s.revisits.same_fraction; });
  row("path driven before in the opposite direction, %", 0,
      [](S s) { return 100 * s.revisits.opposite_fraction; });
  for (size_t bin = 0; bin < kRangeBins.size() + 2; ++bin) {
    char label[64];
    if (bin == kRangeBins.size() + 1) {
      std::snprintf(label, sizeof label, "sky, %% of the sphere");
    } else if (bin == kRangeBins.size()) {
      std::snprintf(label, sizeof label, "farther than %g m, %%", kRangeBins.back());
    } else {
      std::snprintf(label, sizeof label, "%g to %g m, %% of the sphere",
                    bin == 0 ? 0.0 : kRangeBins[bin - 1], kRangeBins[bin]);
    }
    row(label, 1, [bin](S s) { return 100 * s.range_fractions[bin]; });
  }
  row("moving, % of the sphere", 1, [](S s) { return 100 * s.moving_fraction; });
  row("ORB corners, mean", 0, [](S s) { return s.mean_corners; });
  row("ORB corners, poorest image", 0, [](S s) { return s.minimum_corners; });
  return table;
}

}  // namespace orb360::town
