#include "apps/town/drive/traffic.h"

#include <algorithm>
#include <deque>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "apps/town/world/cyclist.h"
#include "tests/apps/town/drive/outline.h"

namespace orb360::town {
namespace {

/// The streets of a town with dense traffic, without its buildings: models are but numbers here.
struct Busy {
  Town town;
  std::unique_ptr<Lap> lap;
  std::unique_ptr<Traffic> traffic;
  double until = 0;

  explicit Busy(uint64_t seed, double density = 1) {
    PlanOptions options;
    options.seed = seed;
    options.spacing = 48;
    options.tour_blocks = 2;
    town.plan = PlanStreets(options);
    for (uint32_t i = 0; i < 20; ++i) {
      town.vehicles.push_back(i);
      town.pedestrians.push_back(100 + i);
      town.cyclists.push_back(200 + kPedalPhases * i);
    }
    lap = std::make_unique<Lap>(town.plan, town.plan.tour, LapOptions{.seed = seed});
    until = lap->duration();
    traffic = std::make_unique<Traffic>(
        town, *lap, TrafficOptions{.seed = seed, .density = density, .until = until});
  }
  Outline OutlineOf(const Ride& ride, const Footprint& footprint, double time) const {
    const RoadPose pose = ride.PoseAt(time);
    return {pose.position, pose.forward, footprint};
  }
  /// All vehicles, the camera's first.
  std::vector<Outline> OutlinesAt(double time) const {
    std::vector<Outline> outlines = {OutlineOf(traffic->own(), {4.5, 1.85}, time)};
    for (const Mover& mover : traffic->movers())
      outlines.push_back(OutlineOf(mover.ride, mover.footprint, time));
    return outlines;
  }
};

const Busy& BusyTown(uint64_t seed) {
  static const std::deque<Busy> towns = [] {
    std::deque<Busy> result;  // whose elements stay in their places
    for (uint64_t i = 0; i < 3; ++i) result.emplace_back(21 + i);
    return result;
  }();
  return towns[seed];
}

TEST(Traffic, NoTwoVehiclesAreEverInOnePlace) {
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const Busy& busy = BusyTown(seed);
    for (double time = 0; time < busy.until; time += 0.07) {
      const std::vector<Outline> outlines = busy.OutlinesAt(time);
      for (size_t a = 0; a < outlines.size(); ++a) {
        for (size_t b = a + 1; b < outlines.size(); ++b) {
          if ((outlines[a].middle - outlines[b].middle).norm() > 8) continue;
          ASSERT_FALSE(Overlap(outlines[a], outlines[b]))
              << "seed " << seed << ", " << time << " s, vehicles " << a << " and " << b;
        }
      }
    }
  }
}

TEST(Traffic, VehiclesStayOnTheCarriageways) {
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const Busy& busy = BusyTown(seed);
    for (double time = 0; time < busy.until; time += 1.1) {
      for (const Outline& outline : busy.OutlinesAt(time)) {
        EXPECT_LT(busy.town.plan.DistanceToRoad(outline.middle), -0.4 * outline.size.width)
            << "seed " << seed << ", " << time << " s";
      }
    }
  }
}

TEST(Traffic, NobodyIsRunOver) {
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const Busy& busy = BusyTown(seed);
    for (double time = 0; time < busy.until; time += 0.11) {
      const std::vector<Outline> outlines = busy.OutlinesAt(time);
      for (const Walker& walker : busy.traffic->walkers()) {
        const Vector2d p = walker.At(busy.town.plan, time).position;
        for (const Outline& outline : outlines) {
          ASSERT_FALSE(Overlap(outline, {p, Vector2d::UnitX(), {0.4, 0.4}}))
              << "seed " << seed << ", " << time << " s";
        }
      }
    }
  }
}

/// Moments at which the camera's car is beside a mover, driving the same way: the mover's place
/// seen from the camera's car passes from ahead to behind (+1) or from behind to ahead (-1).
int TimesPassed(const Busy& busy, const Mover& mover, int direction, double* nearest_beside) {
  int times = 0;
  double before = 0;
  for (double time = 0; time < busy.until; time += 0.1) {
    const RoadPose own = busy.traffic->own().PoseAt(time);
    const RoadPose other = mover.ride.PoseAt(time);
    const Vector2d to_other = other.position - own.position;
    const double along = to_other.dot(own.forward);
    if (to_other.norm() < 6 && own.forward.dot(other.forward) > 0.7) {
      if (direction * before > 0 && direction * along <= 0) {
        ++times;
        *nearest_beside = std::min(*nearest_beside, to_other.norm());
      }
      before = along;
    } else {
      before = 0;
    }
  }
  return times;
}

TEST(Traffic, TheCameraPassesCyclistsAndIsOvertakenAtArmsLength) {
  int cyclists = 0;
  int standing = 0;
  int overtaking = 0;
  double nearest = 1e30;
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const Busy& busy = BusyTown(seed);
    for (const Mover& mover : busy.traffic->movers()) {
      if (mover.pace == Pace::kCycling) cyclists += TimesPassed(busy, mover, 1, &nearest);
      if (mover.pace == Pace::kStanding) standing += TimesPassed(busy, mover, 1, &nearest);
      if (mover.pace == Pace::kFast) overtaking += TimesPassed(busy, mover, -1, &nearest);
    }
  }
  EXPECT_GE(cyclists, 6);
  EXPECT_GE(standing, 2);
  EXPECT_GE(overtaking, 1);
  EXPECT_GT(nearest, 1.2);
  EXPECT_LT(nearest, 2.2);
}

TEST(Traffic, SomeVehiclesDriveOnStreetsThatTheTourDoesNotUse) {
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const Busy& busy = BusyTown(seed);
    const auto is_elsewhere = [&](const Mover& mover, double time) {
      const Vector2d p = mover.ride.PlaceAt(time).position;
      for (double s = 0; s < busy.lap->length(); s += 2) {
        if ((busy.lap->PlaceAt(s).position - p).norm() < 18) return false;
      }
      return true;
    };
    int elsewhere = 0;
    for (const Mover& mover : busy.traffic->movers()) {
      for (double time = 0; time < busy.until; time += 4)
        elsewhere += is_elsewhere(mover, time) ? 1 : 0;
    }
    EXPECT_GT(elsewhere, 5) << "seed " << seed;
  }
}

TEST(Traffic, GrowsWithItsDensity) {
  EXPECT_TRUE(Busy(21, 0).traffic->At(3).empty());
  size_t some = 0;
  size_t many = 0;
  for (uint64_t seed = 0; seed < 3; ++seed) {
    some += Busy(21 + seed, 0.25).traffic->movers().size();
    many += BusyTown(seed).traffic->movers().size();
  }
  EXPECT_GT(some, 9U);
  EXPECT_GT(2 * many, 3 * some);
}

TEST(Traffic, IsAFunctionOfTime) {
  const Busy& busy = BusyTown(0);
  const std::vector<Instance> first = busy.traffic->At(7.3);
  busy.traffic->At(40);
  const std::vector<Instance> again = busy.traffic->At(7.3);
  const std::vector<Instance> from_scratch = Busy(21).traffic->At(7.3);
  ASSERT_EQ(first.size(), again.size());
  ASSERT_EQ(first.size(), from_scratch.size());
  for (size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].world_from_model.matrix(), again[i].world_from_model.matrix());
    EXPECT_EQ(first[i].world_from_model.matrix(), from_scratch[i].world_from_model.matrix());
    EXPECT_EQ(first[i].model, from_scratch[i].model);
  }
}

}  // namespace
}  // namespace orb360::town
