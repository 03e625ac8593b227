#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace orb360 {

/// A rectangle of an image that shows a rectangle of data.
struct Axes {
  Eigen::AlignedBox2d data;
  Eigen::Vector2d origin;  ///< Pixel of the data's lower left corner.
  Eigen::Vector2d size;    ///< Pixels.

  Eigen::Vector2d ToPixel(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d fraction = (p - data.min()).cwiseQuotient(data.sizes());
    return origin + Eigen::Vector2d(fraction.x() * size.x(), -fraction.y() * size.y());
  }
};

/// Returns the data's box with a margin of 5 %, extended to the shape of `size`, so that the scales
/// of both axes are equal.
Eigen::AlignedBox2d EqualAspect(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& size);

/// Returns n such that every n-th point is drawn, because the points between could not be
/// distinguished.
size_t ThinningStep(size_t points);

/// Elements of SVG. Positions are in pixels, y downward; `attributes` are written as in
/// `stroke="#000"`. Numbers are written in the same way in every locale.
std::string Decimal(double value, int decimals);
std::string DrawLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                     const std::string& attributes);
std::string DrawCircle(const Eigen::Vector2d& centre, double radius, const std::string& attributes);
/// Draws points of the data, thinned.
std::string DrawPolyline(const std::vector<Eigen::Vector2d>& points, const Axes& axes,
                         const std::string& attributes);

/// A labelled line of the grid.
struct Tick {
  double at;  ///< In the data.
  std::string label;
};

/// Returns multiples of 1, 2 or 5 times a power of ten from `low` to `high`, about one in each 80
/// pixels of `extent`.
std::vector<Tick> LinearTicks(double low, double high, double extent);

/// Draws frame, grid and labels of both axes.
std::string DrawAxes(const Axes& axes, const std::string& title, const std::string& x_label,
                     const std::string& y_label);
/// Draws the same with a grid of its own for the y axis.
std::string DrawAxes(const Axes& axes, const std::vector<Tick>& y_ticks, const std::string& title,
                     const std::string& x_label, const std::string& y_label);

/// Returns a whole file: elements on a white background.
std::string MakeSvg(const Eigen::Vector2d& size, const std::string& elements);

}  // namespace orb360
