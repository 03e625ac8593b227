#include "slam/evaluation/local_scale_plot.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/evaluation/chart.h"

namespace orb360 {
namespace {

/// Range of ln(ratio) above which the grid has 1, 2 and 5 times powers of ten instead of equal
/// steps of the ratio, and above which it has only the powers.
constexpr double kWideRange = 1.0;
constexpr double kVeryWideRange = 7.0;
constexpr double kLeastRange =
    0.01;                         // of ln(ratio), so that noise of 0.1 % does not fill the chart
constexpr double kMargin = 0.05;  // above and below, as a fraction of the range

/// Returns the grid of ratios from exp(low) to exp(high), with ln(ratio) as data.
std::vector<Tick> RatioTicks(double low, double high, double extent) {
  std::vector<Tick> ticks;
  if (high - low < kWideRange) {
    for (const Tick& tick : LinearTicks(std::exp(low), std::exp(high), extent)) {
      ticks.push_back({std::log(tick.at), tick.label});
    }
    return ticks;
  }
  for (int power = -9; power <= 9; ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      if (digit > 1.0 && high - low > kVeryWideRange) continue;
      const double ratio = digit * std::pow(10.0, power);
      if (std::log(ratio) < low || std::log(ratio) > high) continue;
      ticks.push_back({std::log(ratio), Decimal(ratio, std::max(0, -power))});
    }
  }
  return ticks;
}

std::string Percent(const std::optional<double>& fraction) {
  return fraction ? Decimal(100.0 * *fraction, 2) + " %" : "none";
}

}  // namespace

std::string DrawLocalScale(const LocalScale& scale, const Eigen::Vector2d& origin,
                           const Eigen::Vector2d& size) {
  // The line of the ratio 1 is always inside.
  double low = std::min(0.0, std::log(scale.min));
  double high = std::max(0.0, std::log(scale.max));
  const double margin = kMargin * (high - low) + 0.5 * std::max(0.0, kLeastRange - (high - low));
  low -= margin;
  high += margin;
  const double end = scale.windows.back().begin + LocalScale::kWindow;
  const Axes axes{{Eigen::Vector2d(0, low), Eigen::Vector2d(end, high)}, origin, size};
  std::string svg = DrawAxes(axes, RatioTicks(low, high, size.y()),
                             "local scale: drift in 100 m, median " + Percent(scale.drift_median) +
                                 ", largest " + Percent(scale.drift_worst),
                             "travelled [m]", "true / estimated length of 20 m");
  svg += DrawLine(axes.ToPixel({0, 0}), axes.ToPixel({end, 0}),
                  "stroke=\"#000\" stroke-dasharray=\"6 4\"");
  std::vector<Eigen::Vector2d> line;
  for (size_t i = 0; i < scale.windows.size(); ++i) {
    const double begin = scale.windows[i].begin;
    line.emplace_back(begin + 0.5 * LocalScale::kWindow, std::log(scale.windows[i].ratio));
    const bool ends = i + 1 == scale.windows.size() ||
                      scale.windows[i + 1].begin > begin + 1.5 * LocalScale::kStep;
    if (!ends) continue;
    if (line.size() == 1) {
      svg += DrawCircle(axes.ToPixel(line.front()), 2, "fill=\"#2060c0\"");
    } else {
      svg += DrawPolyline(line, axes, "stroke=\"#2060c0\" stroke-width=\"1.5\"");
    }
    line.clear();
  }
  return svg;
}

}  // namespace orb360
