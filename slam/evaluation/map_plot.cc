#include "slam/evaluation/map_plot.h"

#include <algorithm>
#include <vector>

#include "nn/base/statistics.h"
#include "slam/evaluation/chart.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr size_t kMaxLandmarks = 20000;
constexpr int kShades = 5;  // of links

/// Returns a command of an SVG path.
std::string To(char command, const Eigen::Vector2d& pixel) {
  std::string text(1, command);
  text += Decimal(pixel.x(), 1);
  text += ' ';
  text += Decimal(pixel.y(), 1);
  return text;
}

/// Returns the interval that contains all values except the outermost twentieth at either end.
Eigen::AlignedBox1d Bulk(std::span<const Eigen::Vector2d> points, int axis) {
  if (points.empty()) return {};
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector2d& p : points) values.push_back(p[axis]);
  const size_t outermost = values.size() / 20;
  const double low = OrderStatistic(values, outermost);
  const double high = OrderStatistic(values, values.size() - 1 - outermost);
  return Eigen::AlignedBox1d(Eigen::Matrix<double, 1, 1>(low), Eigen::Matrix<double, 1, 1>(high));
}

/// Returns the box of the keyframes and of most landmarks, extended by at most the extent of the
/// path.
Eigen::AlignedBox2d Extent(std::span<const Eigen::Vector2d> keyframes,
                           std::span<const Eigen::Vector2d> landmarks) {
  Eigen::AlignedBox2d path;
  for (const Eigen::Vector2d& p : keyframes) path.extend(p);
  if (landmarks.empty()) return path;
  const double reach = std::max(path.sizes().maxCoeff(), 1e-3);
  Eigen::AlignedBox2d box = path;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::AlignedBox1d bulk = Bulk(landmarks, axis);
    box.min()[axis] = std::min(path.min()[axis], std::max(bulk.min()[0], path.min()[axis] - reach));
    box.max()[axis] = std::max(path.max()[axis], std::min(bulk.max()[0], path.max()[axis] + reach));
  }
  return box;
}

}  // namespace

std::string PlotMap(std::span<const Eigen::Vector2d> keyframes, std::span<const MapLink> links,
                    std::span<const Eigen::Vector2d> landmarks) {
  ORB360_CHECK(!keyframes.empty());
  const Eigen::Vector2d size(880, 880);
  const Axes axes{EqualAspect(Extent(keyframes, landmarks), size), {90, 930}, size};
  std::string svg = DrawAxes(axes, "from above", "x", "y");
  // Each landmark is a stroke as short as its width, which takes a tenth of the size of a circle.
  std::string marks;
  const size_t step = landmarks.size() / kMaxLandmarks + 1;
  for (size_t i = 0; i < landmarks.size(); i += step) {
    if (axes.data.contains(landmarks[i])) marks += To('M', axes.ToPixel(landmarks[i])) + "h1.2";
  }
  svg += "<path stroke=\"#999\" stroke-width=\"1.2\" d=\"" + marks + "\"/>\n";
  for (int shade = 0; shade < kShades; ++shade) {
    std::string path;
    for (const MapLink& link : links) {
      if (std::clamp(static_cast<int>(link.weight * kShades), 0, kShades - 1) != shade) continue;
      path += To('M', axes.ToPixel(keyframes[link.first])) +
              To('L', axes.ToPixel(keyframes[link.second]));
    }
    svg += "<path stroke=\"#1a9850\" stroke-width=\"0.8\" opacity=\"" +
           Decimal((shade + 1.0) / kShades, 1) + "\" d=\"" + path + "\"/>\n";
  }
  svg += DrawPolyline({keyframes.begin(), keyframes.end()}, axes,
                      "stroke=\"#2040c0\" stroke-width=\"1.2\"");
  for (const Eigen::Vector2d& p : keyframes)
    svg += DrawCircle(axes.ToPixel(p), 2.2, "fill=\"#2040c0\"");
  svg += DrawCircle(axes.ToPixel(keyframes.front()), 6, "fill=\"none\" stroke=\"#000\"");
  return MakeSvg({1000, 1000}, svg);
}

}  // namespace orb360
