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

/// A street: a smooth centreline sampled every metre or so, carriageway width varying along it.
struct Street {
  std::vector<StreetPoint> points;
  double pavement = 3;  ///< width of the pavement on either side
  bool has_centre_line = true;
  bool parking = false;  ///< a row of parked cars on either side, kParkingWidth wide

  /// Metres from the centreline to the middle of what is driven on either side: of the lane, but
  /// where it is very wide, nearer to the centre.
  double LaneOffset(double half_width) const {
    return std::min(0.5 * (half_width - (parking ? kParkingWidth : 0.0)), 2.1);
  }

  double Length() const { return points.back().station; }
  /// Interpolated at `station`, clamped to the street.
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

/// A town's streets and the tour of the camera over them. The z-axis is up; the plan lies in x, y.
struct StreetPlan {
  std::vector<Street> streets;
  std::vector<Junction> junctions;
  std::vector<size_t> tour;  ///< junctions in order, a closed cycle; neighbours share a street
  /// Further closed cycles, each over some street that the tour does not use: cross traffic.
  std::vector<std::vector<size_t>> other_tours;
  double hill_phase = 0;  ///< shifts the terrain

  /// Height of the terrain in metres.
  double Height(const Vector2d& p) const;
  /// Signed distance in metres to the edge of the carriageways, negative on them; streets that
  /// meet are blended so that kerbs go round corners in an arc.
  double DistanceToRoad(const Vector2d& p) const;
  /// As above without one street: whether that street's markings end here.
  double DistanceToOtherRoads(const Vector2d& p, size_t except) const;
  /// Width of the pavement of the street nearest to p.
  double PavementAt(const Vector2d& p) const;
};

struct PlanOptions {
  uint64_t seed = 0;
  int columns = 3;  ///< streets running north-south and east-west before distortion
  int rows = 3;
  double spacing = 60;  ///< mean distance between parallel streets, metres
  int tour_blocks = 3;  ///< blocks that the tour circles
};

/// Bent streets over a distorted lattice, with a tour over its junctions (see PlanTour).
StreetPlan PlanStreets(const PlanOptions& options);

}  // namespace orb360::town
