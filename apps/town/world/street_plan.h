#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

using Eigen::Vector2d;

/// A point of a street's centreline.
struct StreetPoint {
  Vector2d position;
  Vector2d tangent;       ///< unit, along increasing station
  double station = 0;     ///< metres along the centreline
  double half_width = 0;  ///< of the carriageway, between the kerbs
};

inline constexpr double kParkingWidth = 2.1;  // metres

/// A street: a smooth centreline, sampled about every metre, with a varying width of the
/// carriageway.
struct Street {
  std::vector<StreetPoint> points;
  double pavement = 3;  ///< width of the pavement on either side
  bool has_centre_line = true;
  bool parking = false;  ///< a row of parked cars on either side, kParkingWidth wide
  double median = 0;     ///< half the width of the planted strip between the directions; 0: none

  /// Returns the distance from the centreline to the middle of the driven strip on either side,
  /// metres. This is the middle of the lane, or nearer to the centre if the lane is very wide.
  double LaneOffset(double half_width) const {
    return median + std::min(0.5 * (half_width - median - (parking ? kParkingWidth : 0.0)), 2.1);
  }

  double Length() const { return points.back().station; }
  /// Returns the point at `station`, interpolated and clamped to the street.
  StreetPoint At(double station) const;
};

/// Where streets meet.
struct Junction {
  Vector2d position;
  struct Arm {
    size_t street;
    double station;
  };
  std::vector<Arm> arms;  ///< each street that passes through, once
};

/// Raised ground within the carriageway: all points within `radius` of a line (or of a single
/// point).
struct Island {
  std::vector<Vector2d> spine;
  double length = 0;  ///< of the spine, metres
  double radius = 0;

  /// Returns the signed distance to its kerb, metres, negative on it.
  double Distance(const Vector2d& p) const;
};

/// A junction whose traffic goes round an island, counter-clockwise.
struct Roundabout {
  size_t junction = 0;
  Vector2d centre;
  double island_radius = 0;
  double outer_radius = 0;  ///< of the carriageway
};

/// A block without buildings, bounded by the centrelines of the streets around it.
struct Park {
  std::vector<Vector2d> outline;  ///< counter-clockwise
  std::vector<Vector2d> gates;    ///< points of the centrelines opposite its entrances
  Vector2d centre;

  bool Contains(const Vector2d& p) const;
};

/// A railway bridge over a street.
struct Bridge {
  size_t street = 0;
  double station = 0;
  Vector2d centre;
  Vector2d along;           ///< unit, of the street below
  double half_width = 0;    ///< metres along the street
  double half_opening = 0;  ///< metres from the street's centreline to the walls below
  double reach = 0;         ///< metres from the street's centreline to the ends of its walls
};

/// The streets of a town and the tour of the camera over them. The z axis points up; the plan lies
/// in x, y.
struct StreetPlan {
  std::vector<Street> streets;
  std::vector<Junction> junctions;
  std::vector<size_t> tour;  ///< junctions in order, a closed cycle; neighbours share a street
  /// Further closed cycles for cross traffic, each over some street that the tour does not use.
  std::vector<std::vector<size_t>> other_tours;
  std::vector<Roundabout> roundabouts;
  std::vector<Island> islands;  ///< of roundabouts, and medians of avenues
  std::vector<Park> parks;
  std::vector<Bridge> bridges;
  double hill_phase = 0;  ///< shifts the terrain

  /// Returns the height of the terrain, metres.
  double Height(const Vector2d& p) const;
  /// Returns the signed distance to the edge of the carriageways, metres, negative on them. Streets
  /// that meet are blended, so that kerbs are rounded at corners.
  double DistanceToRoad(const Vector2d& p) const;
  /// As above without islands and without one street: tells whether that street's markings end
  /// here.
  double DistanceToOtherRoads(const Vector2d& p, size_t except) const;
  /// Returns the width of the pavement of the street nearest to p, or of the paved edge of an
  /// island at p.
  double PavementAt(const Vector2d& p) const;
  /// Returns the roundabout at a junction, or null.
  const Roundabout* RoundaboutAt(size_t junction) const;
  /// Returns true if a place of a street lies under a bridge or less than `margin` metres from one.
  bool IsUnderBridge(size_t street, double station, double margin) const;
};

struct PlanOptions {
  uint64_t seed = 0;
  int columns = 3;  ///< streets running north-south and east-west before distortion
  int rows = 3;
  double spacing = 60;  ///< mean distance between parallel streets, metres
  int tour_blocks = 3;  ///< blocks that the tour circles
};

/// Plans bent streets over a distorted lattice, with a tour over its junctions (see PlanTour) and,
/// where there is room, an avenue, a roundabout, a park and a bridge.
StreetPlan PlanStreets(const PlanOptions& options);

}  // namespace orb360::town
