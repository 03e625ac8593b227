#include "apps/town/world/ground.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace orb360::town {
namespace {

constexpr double kCell = 1.0;        // metres; the grid the distance to the road is sampled on
constexpr double kReach = 40.0;      // metres from the road to which the ground is built
constexpr double kKerbWidth = 0.18;  // metres

/// A corner of a ground polygon: its position in the plan and its distance to the road.
struct Corner {
  Vector2d position;
  double distance;
};

/// Returns the part of a convex polygon where low <= distance < high.
std::vector<Corner> ClipToBand(const std::vector<Corner>& polygon, double low, double high) {
  const auto clip = [](const std::vector<Corner>& source, double limit, double sign) {
    std::vector<Corner> result;
    for (size_t i = 0; i < source.size(); ++i) {
      const Corner& a = source[i];
      const Corner& b = source[(i + 1) % source.size()];
      const double da = sign * (a.distance - limit);
      const double db = sign * (b.distance - limit);
      if (da >= 0) result.push_back(a);
      if ((da >= 0) != (db >= 0)) {
        const double t = da / (da - db);
        result.push_back({a.position + t * (b.position - a.position), limit});
      }
    }
    return result;
  };
  return clip(clip(polygon, low, 1), high, -1);
}

/// One kind of ground between two distances from the road.
struct Band {
  double low;
  double high;
  double height;
  MaterialId material;
};

void AddBand(const StreetPlan& plan, const Band& band, const std::vector<Corner>& triangle,
             MeshBuilder& builder) {
  std::vector<Vector3f> corners;
  for (const Corner& corner : ClipToBand(triangle, band.low, band.high)) {
    corners.emplace_back(Eigen::Vector3d(corner.position.x(), corner.position.y(),
                                         plan.Height(corner.position) + band.height)
                             .cast<float>());
  }
  builder.AddGroundPolygon(band.material, corners);
}

/// Adds the face of the kerb: the vertical strip over the edge of the road in this triangle.
void AddKerbFace(const StreetPlan& plan, const std::vector<Corner>& triangle,
                 MeshBuilder& builder) {
  std::vector<Vector2d> ends;
  for (size_t i = 0; i < 3; ++i) {
    const Corner& a = triangle[i];
    const Corner& b = triangle[(i + 1) % 3];
    if ((a.distance >= 0) == (b.distance >= 0)) continue;
    const double t = a.distance / (a.distance - b.distance);
    const Vector2d p = a.position + t * (b.position - a.position);
    // Counter-clockwise around the road side: enters where the distance falls below zero.
    if (a.distance >= 0)
      ends.insert(ends.begin(), p);
    else
      ends.push_back(p);
  }
  if (ends.size() != 2) return;
  const auto lift = [&](const Vector2d& p, double height) -> Vector3f {
    return Eigen::Vector3d(p.x(), p.y(), plan.Height(p) + height).cast<float>();
  };
  builder.AddFace(builder.materials().kerb, lift(ends[1], 0), lift(ends[0], 0),
                  lift(ends[0], kKerbHeight), lift(ends[1], kKerbHeight));
}

/// Adds a strip of paint between stations s0 and s1, lateral offsets y0 < y1 (positive to the
/// left).
void AddStrip(const StreetPlan& plan, const Street& street, double s0, double s1, double y0,
              double y1, MeshBuilder& builder) {
  constexpr double kThickness = 0.002;  // metres; the triangles of a slope are up to 0.4 mm off it
  constexpr double kPiece = 1.0;        // metres at most, like the cells of the ground
  const int along = std::max(1, static_cast<int>(std::ceil((s1 - s0) / kPiece)));
  const int across = std::max(1, static_cast<int>(std::ceil((y1 - y0) / kPiece)));
  const auto corner = [&](int i, int j) -> Vector3f {
    const StreetPoint p = street.At(std::lerp(s0, s1, static_cast<double>(i) / along));
    const double y = std::lerp(y0, y1, static_cast<double>(j) / across);
    const Vector2d q = p.position + y * Vector2d(-p.tangent.y(), p.tangent.x());
    return Eigen::Vector3d(q.x(), q.y(), plan.Height(q) + kThickness).cast<float>();
  };
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < across; ++j) {
      builder.AddGroundPolygon(
          builder.materials().road_paint,
          {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
    }
  }
}

}  // namespace

void AddGround(const StreetPlan& plan, MeshBuilder& builder) {
  Vector2d low(1e30, 1e30);
  Vector2d high(-1e30, -1e30);
  for (const Street& street : plan.streets) {
    for (const StreetPoint& point : street.points) {
      low = low.cwiseMin(point.position);
      high = high.cwiseMax(point.position);
    }
  }
  low.array() -= kReach;
  high.array() += kReach;
  const int columns = static_cast<int>((high.x() - low.x()) / kCell);
  const int rows = static_cast<int>((high.y() - low.y()) / kCell);
  const auto position = [&](int column, int row) -> Vector2d {
    return low + kCell * Vector2d(column, row);
  };
  std::vector<double> distance(static_cast<size_t>(columns + 1) * static_cast<size_t>(rows + 1));
  const auto at = [&](int column, int row) -> double& {
    return distance[static_cast<size_t>(row) * static_cast<size_t>(columns + 1) +
                    static_cast<size_t>(column)];
  };
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column)
      at(column, row) = plan.DistanceToRoad(position(column, row));
  }
  const Materials& m = builder.materials();
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::array<Corner, 4> cell = {{{position(column, row), at(column, row)},
                                           {position(column + 1, row), at(column + 1, row)},
                                           {position(column + 1, row + 1), at(column + 1, row + 1)},
                                           {position(column, row + 1), at(column, row + 1)}}};
      double nearest = 1e30;
      double farthest = -1e30;
      for (const Corner& corner : cell) {
        nearest = std::min(nearest, corner.distance);
        farthest = std::max(farthest, corner.distance);
      }
      if (nearest > kReach) continue;
      const double pavement = nearest < 8 ? plan.PavementAt(cell[0].position) : 3;
      const std::array<Band, 4> bands = {{{-1e30, 0, 0, m.asphalt},
                                          {0, kKerbWidth, kKerbHeight, m.kerb},
                                          {kKerbWidth, pavement, kKerbHeight, m.paving},
                                          {pavement, 1e30, kKerbHeight - 0.02, m.grass}}};
      for (const auto& corners : {std::vector<Corner>{cell[0], cell[1], cell[2]},
                                  std::vector<Corner>{cell[0], cell[2], cell[3]}}) {
        for (const Band& band : bands) {
          if (band.high > nearest && band.low < farthest) AddBand(plan, band, corners, builder);
        }
        if (nearest < 0 && farthest >= 0) AddKerbFace(plan, corners, builder);
      }
    }
  }
}

void AddRoadMarkings(const StreetPlan& plan, MeshBuilder& builder) {
  builder.set_tint({1, 1, 1, 1});
  for (size_t index = 0; index < plan.streets.size(); ++index) {
    const Street& street = plan.streets[index];
    // Lines end shortly before another road's carriageway.
    const auto clear = [&](double s, double margin) {
      return plan.DistanceToOtherRoads(street.At(s).position, index) > margin;
    };
    constexpr double kDash = 3.0;
    constexpr double kGap = 4.5;
    for (double s = 1; s + kDash < street.Length(); s += kDash + kGap) {
      if (street.has_centre_line && clear(s, 7) && clear(s + kDash, 7))
        AddStrip(plan, street, s, s + kDash, -0.06, 0.06, builder);
    }
    for (double s = 1; s + 2 < street.Length(); s += 2) {
      if (!clear(s, 9) || !clear(s + 2, 9)) continue;
      const double edge = street.At(s).half_width - (street.parking ? kParkingWidth : 0.35);
      AddStrip(plan, street, s, s + 2, edge - 0.1, edge, builder);
      AddStrip(plan, street, s, s + 2, -edge, -edge + 0.1, builder);
    }
  }
  for (const Junction& junction : plan.junctions) {
    for (const Junction::Arm& arm : junction.arms) {
      const Street& street = plan.streets[arm.street];
      for (const double direction : {-1.0, 1.0}) {
        // The zebra crossing starts where the street is clear of the others' carriageways.
        double s = arm.station;
        while (s > 0 && s < street.Length() &&
               plan.DistanceToOtherRoads(street.At(s).position, arm.street) < 3.0)
          s += 0.5 * direction;
        const double start = direction > 0 ? s : s - 3;
        if (start < 1 || start + 4 > street.Length()) continue;
        const double edge = street.At(start).half_width - 0.5;
        for (double y = -edge; y + 0.5 <= edge; y += 1.0)
          AddStrip(plan, street, start, start + 3, y, y + 0.5, builder);
        // The stop line crosses the lane that leads to the junction (traffic keeps right).
        const double stop = direction > 0 ? start + 4 : start - 1.4;
        if (stop < 1 || stop + 1 > street.Length()) continue;
        if (direction > 0)
          AddStrip(plan, street, stop, stop + 0.4, street.median + 0.15, edge, builder);
        else
          AddStrip(plan, street, stop, stop + 0.4, -edge, -street.median - 0.15, builder);
      }
    }
  }
}

}  // namespace orb360::town
