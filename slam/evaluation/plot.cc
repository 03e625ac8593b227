#include "slam/evaluation/plot.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slam/check.h"

namespace orb360 {
namespace {

constexpr double kWidth = 1400.0;
constexpr double kHeight = 640.0;
/// More points than that are not to be told apart; long trajectories are thinned to it.
constexpr size_t kMostPoints = 4000;

std::string Number(double value, int decimals) {
  std::array<char, 400> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value + 0.0,
                                    std::chars_format::fixed, decimals);
  return {buffer.data(), result.ptr};
}

std::string Pixel(double value) { return Number(value, 1); }

/// 1, 2 or 5 times a power of ten, so that about `count` steps make up `extent`.
double TickStep(double extent, int count) {
  const double raw = extent / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double digit = raw / power;
  return power * (digit < 1.5 ? 1.0 : digit < 3.5 ? 2.0 : digit < 7.5 ? 5.0 : 10.0);
}

int TickDecimals(double step) {
  return std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
}

/// From no error (blue) over green and yellow to the largest (red).
std::string ErrorColor(double share) {
  const double hue = 220.0 * (1.0 - std::clamp(share, 0.0, 1.0));
  return "hsl(" + Number(hue, 0) + ",85%,45%)";
}

/// A rectangle of the picture that shows a rectangle of the data.
struct Axes {
  Eigen::AlignedBox2d data;
  Eigen::Vector2d origin;  ///< Pixel of the data's lower left corner.
  Eigen::Vector2d size;    ///< Pixels.

  Eigen::Vector2d ToPixel(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d share = (p - data.min()).cwiseQuotient(data.sizes());
    return origin + Eigen::Vector2d(share.x() * size.x(), -share.y() * size.y());
  }
};

std::string Text(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + Pixel(x) + "\" y=\"" + Pixel(y) + "\" text-anchor=\"" + anchor + "\">" +
         text + "</text>\n";
}

std::string Line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                 const std::string& attributes) {
  return "<line x1=\"" + Pixel(from.x()) + "\" y1=\"" + Pixel(from.y()) + "\" x2=\"" +
         Pixel(to.x()) + "\" y2=\"" + Pixel(to.y()) + "\" " + attributes + "/>\n";
}

/// Frame, grid and labels of both axes.
std::string DrawAxes(const Axes& axes, const std::string& title, const std::string& x_label,
                     const std::string& y_label) {
  const Eigen::Vector2d corner = axes.origin - Eigen::Vector2d(0, axes.size.y());
  std::string svg = "<rect x=\"" + Pixel(corner.x()) + "\" y=\"" + Pixel(corner.y()) +
                    "\" width=\"" + Pixel(axes.size.x()) + "\" height=\"" + Pixel(axes.size.y()) +
                    "\" fill=\"none\" stroke=\"#888\"/>\n";
  for (int axis = 0; axis < 2; ++axis) {
    const double low = axes.data.min()[axis];
    const double high = axes.data.max()[axis];
    const double step = TickStep(high - low, static_cast<int>(axes.size[axis] / 80.0));
    for (long i = std::lround(std::ceil(low / step)); step * static_cast<double>(i) <= high; ++i) {
      const double tick = step * static_cast<double>(i);
      Eigen::Vector2d from = axes.data.min();
      Eigen::Vector2d to = axes.data.max();
      from[axis] = to[axis] = tick;
      const Eigen::Vector2d at = axes.ToPixel(from);
      svg += Line(at, axes.ToPixel(to), "stroke=\"#e4e4e4\"");
      const std::string label = Number(tick, TickDecimals(step));
      svg += axis == 0 ? Text(at.x(), at.y() + 18, "middle", label)
                       : Text(at.x() - 6, at.y() + 4, "end", label);
    }
  }
  svg += Text(corner.x() + axes.size.x() / 2, axes.origin.y() + 38, "middle", x_label);
  svg += Text(corner.x(), corner.y() - 10, "start", y_label);
  svg += Text(corner.x() + axes.size.x() / 2, corner.y() - 10, "middle", title);
  return svg;
}

std::string Polyline(const std::vector<Eigen::Vector2d>& points, const Axes& axes,
                     const std::string& attributes) {
  std::string svg = "<polyline fill=\"none\" " + attributes + " points=\"";
  const size_t step = points.size() / kMostPoints + 1;
  for (size_t i = 0; i < points.size(); i += step) {
    const Eigen::Vector2d pixel = axes.ToPixel(points[i]);
    svg += Pixel(pixel.x()) + "," + Pixel(pixel.y()) + " ";
  }
  return svg + "\"/>\n";
}

/// The data's box with a margin of 5 %, extended to the shape of `size`, so that a metre is the
/// same to the right and upward.
Eigen::AlignedBox2d EqualAspect(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& size) {
  const double metres_per_pixel =
      1.1 * std::max({box.sizes().x() / size.x(), box.sizes().y() / size.y(), 1e-9});
  const Eigen::Vector2d half = 0.5 * metres_per_pixel * size;
  return {box.center() - half, box.center() + half};
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
  svg += Polyline(true_path, axes, "stroke=\"#999\" stroke-width=\"4\" stroke-linejoin=\"round\"");
  const size_t step = path.size() / kMostPoints + 1;
  for (size_t i = step; i < path.size(); i += step) {
    const double share = errors.position_errors[i] / std::max(errors.ate_sim3.max, 1e-12);
    svg += Line(axes.ToPixel(path[i - step]), axes.ToPixel(path[i]),
                "stroke=\"" + ErrorColor(share) + "\" stroke-width=\"2\"");
  }
  const Eigen::Vector2d start = axes.ToPixel(path.front());
  svg += "<circle cx=\"" + Pixel(start.x()) + "\" cy=\"" + Pixel(start.y()) +
         "\" r=\"5\" fill=\"none\" stroke=\"#000\"/>\n";
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
                             "position error: RMSE " + Number(errors.ate_sim3.rmse, 3) +
                                 " m, largest " + Number(errors.ate_sim3.max, 3) + " m",
                             "time [s]", "error [m]");
  svg +=
      Line(axes.ToPixel({begin, errors.ate_sim3.rmse}), axes.ToPixel({end, errors.ate_sim3.rmse}),
           "stroke=\"#000\" stroke-dasharray=\"6 4\"");
  return svg + Polyline(points, axes, "stroke=\"#c03020\" stroke-width=\"1.5\"");
}

}  // namespace

std::string PlotTrajectory(std::span<const StampedPose> truth, std::span<const PosePair> pairs,
                           const TrajectoryErrors& errors) {
  ORB360_CHECK(!pairs.empty() && pairs.size() == errors.position_errors.size(), pairs.size(),
               errors.position_errors.size());
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + Number(kWidth, 0) + " " +
         Number(kHeight, 0) + "\" width=\"" + Number(kWidth, 0) + "\" height=\"" +
         Number(kHeight, 0) + "\" font-family=\"sans-serif\" font-size=\"13\">\n" +
         "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         DrawFromAbove(truth, pairs, errors) + DrawOverTime(pairs, errors) + "</svg>\n";
}

}  // namespace orb360
