#include "slam/evaluation/trajectory_plot.h"

#include <algorithm>
#include <vector>

#include "slam/evaluation/chart.h"
#include "slam/evaluation/local_scale_plot.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Returns a colour from blue (no error) over green and yellow to red (the largest error).
std::string ErrorColor(double fraction) {
  const double hue = 220.0 * (1.0 - std::clamp(fraction, 0.0, 1.0));
  return "hsl(" + Decimal(hue, 0) + ",85%,45%)";
}

std::string DrawFromAbove(std::span<const StampedPose> truth, std::span<const PosePair> pairs,
                          const TrajectoryErrors& errors) {
  std::vector<Eigen::Vector2d> true_path;
  std::vector<Eigen::Vector2d> path;
  Eigen::AlignedBox2d box;
  for (const StampedPose& pose : truth) {
    true_path.emplace_back(pose.world_from_camera.translation.head<2>());
    box.extend(true_path.back());
  }
  for (const PosePair& pair : pairs) {
    path.emplace_back(
        (errors.truth_from_estimate * pair.estimate_from_camera.translation).head<2>());
    box.extend(path.back());
  }
  const Eigen::Vector2d size(580, 520);
  const Axes axes{EqualAspect(box, size), {70, 580}, size};
  std::string svg = DrawAxes(axes, "from above (grey: ground truth)", "x [m]", "y [m]");
  svg +=
      DrawPolyline(true_path, axes, "stroke=\"#999\" stroke-width=\"4\" stroke-linejoin=\"round\"");
  const size_t step = ThinningStep(path.size());
  for (size_t i = step; i < path.size(); i += step) {
    const double fraction = errors.position_errors[i] / std::max(errors.ate_sim3.max, 1e-12);
    svg += DrawLine(axes.ToPixel(path[i - step]), axes.ToPixel(path[i]),
                    "stroke=\"" + ErrorColor(fraction) + "\" stroke-width=\"2\"");
  }
  const Eigen::Vector2d start = axes.ToPixel(path.front());
  svg += DrawCircle(start, 5, "fill=\"none\" stroke=\"#000\"");
  return svg;
}

std::string DrawOverTime(std::span<const PosePair> pairs, const TrajectoryErrors& errors) {
  std::vector<Eigen::Vector2d> points;
  for (size_t i = 0; i < pairs.size(); ++i) {
    points.emplace_back(pairs[i].timestamp, errors.position_errors[i]);
  }
  const double begin = points.front().x();
  const double end = std::max(points.back().x(), begin + 1e-6);
  const double top = 1.1 * std::max(errors.ate_sim3.max, 1e-6);
  const Axes axes{{Eigen::Vector2d(begin, 0), Eigen::Vector2d(end, top)}, {740, 580}, {630, 520}};
  std::string svg = DrawAxes(axes,
                             "position error: RMSE " + Decimal(errors.ate_sim3.rmse, 3) +
                                 " m, largest " + Decimal(errors.ate_sim3.max, 3) + " m",
                             "time [s]", "error [m]");
  svg += DrawLine(axes.ToPixel({begin, errors.ate_sim3.rmse}),
                  axes.ToPixel({end, errors.ate_sim3.rmse}),
                  "stroke=\"#000\" stroke-dasharray=\"6 4\"");
  return svg + DrawPolyline(points, axes, "stroke=\"#c03020\" stroke-width=\"1.5\"");
}

}  // namespace

std::string PlotTrajectory(std::span<const StampedPose> truth, std::span<const PosePair> pairs,
                           const TrajectoryErrors& errors, const std::optional<LocalScale>& scale) {
  ORB360_CHECK(!pairs.empty() && pairs.size() == errors.position_errors.size(), pairs.size(),
               errors.position_errors.size());
  const std::string charts = DrawFromAbove(truth, pairs, errors) + DrawOverTime(pairs, errors);
  if (!scale) return MakeSvg({1400, 640}, charts);
  return MakeSvg({1400, 1000}, charts + DrawLocalScale(*scale, {70, 940}, {1300, 240}));
}

}  // namespace orb360
