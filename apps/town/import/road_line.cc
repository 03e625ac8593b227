#include "apps/town/import/road_line.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr double kStep = 1;         // metres between the places
constexpr double kAbove = 2;        // metres above the sections where rays downward begin
constexpr double kBelow = 8;        // metres that they are long
constexpr double kClearance = 0.8;  // metres that are free on both sides of a place
constexpr int kReach = 6;           // places on each side over which lines are smoothed

/// A place on the road with its direction to the right, horizontal and of unit length.
struct Place {
  Eigen::Vector3d middle;
  Eigen::Vector3d right;
  double half_width;
};

Eigen::Vector3d Horizontal(Eigen::Vector3d v) {
  v.z() = 0;
  return v.norm() > 1e-6 ? v.normalized() : Eigen::Vector3d::UnitX();
}

/// Returns the mean over `reach` neighbours on each side with weights that fall to zero.
template <typename T>
std::vector<T> Smooth(const std::vector<T>& ring, int reach) {
  const auto count = static_cast<int>(ring.size());
  std::vector<T> result;
  for (int i = 0; i < count; ++i) {
    T sum = ring[static_cast<size_t>(i)] * 0;
    double weights = 0;
    for (int k = -reach; k <= reach; ++k) {
      const double weight = reach + 1 - std::abs(k);
      sum += weight * ring[static_cast<size_t>(((i + k) % count + count) % count)];
      weights += weight;
    }
    result.push_back(sum / weights);
  }
  return result;
}

/// Refuses what is no road of this world, before memory is taken for its places.
void RequireRoad(const std::vector<RoadWidth>& sections) {
  constexpr double kLongest = 100'000;  // metres
  constexpr double kWidest = 1000;      // metres
  double length = 0;
  for (size_t i = 0; i < sections.size(); ++i) {
    const RoadWidth& a = sections[i];
    const RoadWidth& b = sections[(i + 1) % sections.size()];
    length += 0.5 * (b.left + b.right - a.left - a.right).norm();
    if (!((a.right - a.left).norm() <= kWidest))
      throw UserError("the driveline is more than 1 km wide");
  }
  if (!(length >= 3 * kStep && length <= kLongest))
    throw UserError("the driveline is not between 3 m and 100 km long");
}

/// Returns places of equal distance along the middle of the sections.
std::vector<Place> Subdivide(const std::vector<RoadWidth>& sections) {
  std::vector<Eigen::Vector3d> left;
  std::vector<Eigen::Vector3d> right;
  for (size_t i = 0; i < sections.size(); ++i) {
    const RoadWidth& a = sections[i];
    const RoadWidth& b = sections[(i + 1) % sections.size()];
    const double length = 0.5 * (b.left + b.right - a.left - a.right).norm();
    const int steps = static_cast<int>(std::ceil(length / kStep));
    for (int k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      left.emplace_back((1 - t) * a.left + t * b.left);
      right.emplace_back((1 - t) * a.right + t * b.right);
    }
  }
  left = Smooth(left, kReach);  // rounds the bends between quads
  right = Smooth(right, kReach);
  std::vector<Place> places;
  for (size_t i = 0; i < left.size(); ++i) {
    const Eigen::Vector3d across = right[i] - left[i];
    places.push_back({0.5 * (left[i] + right[i]), Horizontal(across), 0.5 * across.norm()});
  }
  return places;
}

std::optional<double> GroundHeight(const RayScene& scene, const Eigen::Vector3d& p) {
  const Eigen::Vector3d from = p + kAbove * Eigen::Vector3d::UnitZ();
  const double depth = DistanceAlong(scene, from.cast<float>(), -Vector3f::UnitZ(),
                                     static_cast<float>(kAbove + kBelow));
  if (depth >= kAbove + kBelow) return std::nullopt;
  return from.z() - depth;
}

/// Fills gaps between known numbers of a ring linearly, with zeros if none is known.
std::vector<double> FillGaps(const std::vector<std::optional<double>>& ring) {
  const size_t count = ring.size();
  std::vector<double> result(count, 0);
  const auto first = std::find_if(ring.begin(), ring.end(), [](const auto& v) { return v; });
  if (first == ring.end()) return result;
  const auto start = static_cast<size_t>(first - ring.begin());
  size_t last = 0;  // steps from the start to the last known number
  for (size_t k = 0; k <= count; ++k) {
    const std::optional<double>& here = ring[(start + k) % count];
    if (!here) continue;
    const double before = *ring[(start + last) % count];
    for (size_t j = last; j < k; ++j) {
      const double t = static_cast<double>(j - last) / static_cast<double>(k - last);
      result[(start + j) % count] = (1 - t) * before + t * *here;
    }
    last = k;
  }
  return result;
}

/// Returns the median over `reach` neighbours on each side, so that what is narrow is ignored.
std::vector<double> Medians(const std::vector<double>& ring, int reach) {
  const auto count = static_cast<int>(ring.size());
  std::vector<double> result;
  for (int i = 0; i < count; ++i) {
    std::vector<double> near;
    for (int k = -reach; k <= reach; ++k)
      near.push_back(ring[static_cast<size_t>(((i + k) % count + count) % count)]);
    std::nth_element(near.begin(), near.begin() + reach, near.end());
    result.push_back(near[static_cast<size_t>(reach)]);
  }
  return result;
}

/// Returns the positions of a camera above the places, moved to the right by `shifts`.
std::vector<Eigen::Vector3d> Raise(const RayScene& scene, const std::vector<Place>& places,
                                   const std::vector<double>& shifts, double height) {
  std::vector<std::optional<double>> differences;
  for (size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d p = places[i].middle + shifts[i] * places[i].right;
    const std::optional<double> ground = GroundHeight(scene, p);
    differences.push_back(ground ? std::optional(*ground - p.z()) : std::nullopt);
  }
  const std::vector<double> filled = Smooth(Medians(FillGaps(differences), 4), 2);
  std::vector<Eigen::Vector3d> positions;
  for (size_t i = 0; i < places.size(); ++i) {
    positions.emplace_back(places[i].middle + shifts[i] * places[i].right +
                           (filled[i] + height) * Eigen::Vector3d::UnitZ());
  }
  return positions;
}

/// Returns true if nothing stands within kClearance on either side, nor within it ahead.
bool IsFree(const RayScene& scene, const Eigen::Vector3d& p, const Eigen::Vector3d& right,
            const Eigen::Vector3d& ahead) {
  const auto is_open = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
    return DistanceAlong(scene, from.cast<float>(), way.cast<float>(), 1) >= 1;
  };
  const Eigen::Vector3d side = kClearance * right;
  return is_open(p, side) && is_open(p, -side) && is_open(p, ahead) && is_open(p + side, ahead) &&
         is_open(p - side, ahead);
}

/// Returns for each place how far to the right of its position, which is `present` off the middle,
/// the nearest free one on the road is; 0 if there is none.
std::vector<double> FreeShifts(const RayScene& scene, const std::vector<Place>& places,
                               const std::vector<double>& present,
                               const std::vector<Eigen::Vector3d>& positions) {
  constexpr double kShiftStep = 0.25;
  constexpr double kFarAhead = 3;  // metres
  std::vector<double> shifts;
  for (size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d along =
        (positions[(i + 1) % positions.size()] - positions[i]).normalized() * kFarAhead;
    double best = 0;
    for (double size = 0; size < places[i].half_width; size += kShiftStep) {
      const auto is_free = [&](double shift) {
        return std::abs(present[i] + shift) < places[i].half_width &&
               IsFree(scene, positions[i] + shift * places[i].right, places[i].right, along);
      };
      // On which side the line swerves already is preferred.
      const double side = !shifts.empty() && shifts.back() < 0 ? -1 : 1;
      if (is_free(side * size))
        best = side * size;
      else if (is_free(-side * size))
        best = -side * size;
      else
        continue;
      break;
    }
    shifts.push_back(best);
  }
  return shifts;
}

/// Widens each swerve, so that it is complete where it is needed after it has been smoothed.
std::vector<double> Widen(const std::vector<double>& shifts, int reach) {
  const auto count = static_cast<int>(shifts.size());
  std::vector<double> result;
  for (int i = 0; i < count; ++i) {
    double widest = 0;
    for (int k = -reach; k <= reach; ++k) {
      const double there = shifts[static_cast<size_t>(((i + k) % count + count) % count)];
      if (std::abs(there) > std::abs(widest)) widest = there;
    }
    result.push_back(widest);
  }
  return result;
}

}  // namespace

std::vector<Eigen::Vector3d> FollowRoad(const RayScene& scene,
                                        const std::vector<RoadWidth>& sections, double height) {
  constexpr int kRounds = 3;  // a swerve may lead to something else
  RequireRoad(sections);
  const std::vector<Place> places = Subdivide(sections);
  std::vector<double> shifts(places.size(), 0);
  std::vector<Eigen::Vector3d> positions = Raise(scene, places, shifts, height);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> more =
        Smooth(Widen(FreeShifts(scene, places, shifts, positions), kReach), kReach);
    for (size_t i = 0; i < shifts.size(); ++i) shifts[i] += more[i];
    positions = Raise(scene, places, shifts, height);
  }
  return positions;
}

}  // namespace orb360::town
