#include "slam/evaluation/chart.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace orb360 {
namespace {

constexpr size_t kMaxPoints = 4000;
constexpr double kTickDistance = 80.0;  // pixels

std::string Pixel(double value) { return Decimal(value, 1); }

/// Returns 1, 2 or 5 times a power of ten, so that about `count` steps cover `extent`.
double TickStep(double extent, int count) {
  const double raw = extent / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double digit = raw / power;
  return power * (digit < 1.5 ? 1.0 : digit < 3.5 ? 2.0 : digit < 7.5 ? 5.0 : 10.0);
}

int TickDecimals(double step) {
  return std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
}

std::string Text(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + Pixel(x) + "\" y=\"" + Pixel(y) + "\" text-anchor=\"" + anchor + "\">" +
         text + "</text>\n";
}

}  // namespace

Eigen::AlignedBox2d EqualAspect(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& size) {
  const double metres_per_pixel =
      1.1 * std::max({box.sizes().x() / size.x(), box.sizes().y() / size.y(), 1e-9});
  const Eigen::Vector2d half = 0.5 * metres_per_pixel * size;
  return {box.center() - half, box.center() + half};
}

size_t ThinningStep(size_t points) { return points / kMaxPoints + 1; }

std::string Decimal(double value, int decimals) {
  std::array<char, 400> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value + 0.0,
                                    std::chars_format::fixed, decimals);
  return {buffer.data(), result.ptr};
}

std::string DrawLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                     const std::string& attributes) {
  return "<line x1=\"" + Pixel(from.x()) + "\" y1=\"" + Pixel(from.y()) + "\" x2=\"" +
         Pixel(to.x()) + "\" y2=\"" + Pixel(to.y()) + "\" " + attributes + "/>\n";
}

std::string DrawCircle(const Eigen::Vector2d& centre, double radius,
                       const std::string& attributes) {
  return "<circle cx=\"" + Pixel(centre.x()) + "\" cy=\"" + Pixel(centre.y()) + "\" r=\"" +
         Pixel(radius) + "\" " + attributes + "/>\n";
}

std::string DrawPolyline(const std::vector<Eigen::Vector2d>& points, const Axes& axes,
                         const std::string& attributes) {
  std::string svg = "<polyline fill=\"none\" " + attributes + " points=\"";
  const size_t step = ThinningStep(points.size());
  for (size_t i = 0; i < points.size(); i += step) {
    const Eigen::Vector2d pixel = axes.ToPixel(points[i]);
    svg += Pixel(pixel.x()) + "," + Pixel(pixel.y()) + " ";
  }
  return svg + "\"/>\n";
}

std::vector<Tick> LinearTicks(double low, double high, double extent) {
  const double step = TickStep(high - low, static_cast<int>(extent / kTickDistance));
  std::vector<Tick> ticks;
  for (long i = std::lround(std::ceil(low / step)); step * static_cast<double>(i) <= high; ++i) {
    const double at = step * static_cast<double>(i);
    ticks.push_back({at, Decimal(at, TickDecimals(step))});
  }
  return ticks;
}

std::string DrawAxes(const Axes& axes, const std::string& title, const std::string& x_label,
                     const std::string& y_label) {
  return DrawAxes(axes, LinearTicks(axes.data.min().y(), axes.data.max().y(), axes.size.y()), title,
                  x_label, y_label);
}

std::string DrawAxes(const Axes& axes, const std::vector<Tick>& y_ticks, const std::string& title,
                     const std::string& x_label, const std::string& y_label) {
  const Eigen::Vector2d corner = axes.origin - Eigen::Vector2d(0, axes.size.y());
  std::string svg = "<rect x=\"" + Pixel(corner.x()) + "\" y=\"" + Pixel(corner.y()) +
                    "\" width=\"" + Pixel(axes.size.x()) + "\" height=\"" + Pixel(axes.size.y()) +
                    "\" fill=\"none\" stroke=\"#888\"/>\n";
  const std::vector<Tick> x_ticks =
      LinearTicks(axes.data.min().x(), axes.data.max().x(), axes.size.x());
  for (int axis = 0; axis < 2; ++axis) {
    for (const Tick& tick : axis == 0 ? x_ticks : y_ticks) {
      Eigen::Vector2d from = axes.data.min();
      Eigen::Vector2d to = axes.data.max();
      from[axis] = to[axis] = tick.at;
      const Eigen::Vector2d at = axes.ToPixel(from);
      svg += DrawLine(at, axes.ToPixel(to), "stroke=\"#e4e4e4\"");
      svg += axis == 0 ? Text(at.x(), at.y() + 18, "middle", tick.label)
                       : Text(at.x() - 6, at.y() + 4, "end", tick.label);
    }
  }
  svg += Text(corner.x() + axes.size.x() / 2, axes.origin.y() + 38, "middle", x_label);
  svg += Text(corner.x(), corner.y() - 10, "start", y_label);
  svg += Text(corner.x() + axes.size.x() / 2, corner.y() - 10, "middle", title);
  return svg;
}

std::string MakeSvg(const Eigen::Vector2d& size, const std::string& elements) {
  const std::string width = Decimal(size.x(), 0);
  const std::string height = Decimal(size.y(), 0);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + width + " " + height +
         "\" width=\"" + width + "\" height=\"" + height +
         "\" font-family=\"sans-serif\" font-size=\"13\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         elements + "</svg>\n";
}

}  // namespace orb360
