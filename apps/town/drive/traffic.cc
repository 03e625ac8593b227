#include "apps/town/drive/traffic.h"

#include <algorithm>
#include <cmath>

#include "apps/town/drive/traffic_planner.h"
#include "apps/town/image/random.h"
#include "apps/town/world/cyclist.h"
#include "apps/town/world/ground.h"
#include "apps/town/world/pedestrian.h"
#include "apps/town/world/vehicle.h"

namespace orb360::town {
namespace {

/// Number of attempts to fit an object in before it is left out.
constexpr int kTries = 12;
constexpr int kFastTries = 40;  // who overtakes needs a clear road more often

/// Returns true if a lap runs straight, far from junctions, around a station.
bool IsOpenRoad(const StreetPlan& plan, const Lap& lap, double station) {
  constexpr double kAbout = 14;  // metres
  const RoadPose here = lap.PoseAt(station);
  if (lap.PoseAt(station - kAbout).forward.dot(lap.PoseAt(station + kAbout).forward) < 0.95)
    return false;
  return std::none_of(plan.junctions.begin(), plan.junctions.end(), [&](const Junction& junction) {
    return (junction.position - here.position).norm() < kAbout;
  });
}

/// Draws vehicles and fits them in.
class Dispatcher {
 public:
  Dispatcher(const Town& town, const TrafficOptions& options, TrafficPlanner* planner)
      : town_(&town), density_(options.density), planner_(planner), random_(options.seed) {}

  /// Adds as many vehicles as `every` seconds of the drive and the density require. Each meets the
  /// camera's car at some moment on an open road.
  void Encounter(const Lap& lap, Pace pace, double every) {
    const double seconds = planner_->moments().until - planner_->moments().from;
    const int slots = static_cast<int>(std::lround(seconds / every + 0.5));
    for (int slot = 0; slot < slots; ++slot) {
      if (!random_.Chance(density_)) continue;
      for (int i = 0; i < (pace == Pace::kFast ? kFastTries : kTries); ++i) {
        Mover mover = Draw(lap, pace);
        const double time = random_.Uniform(planner_->moments().from, planner_->moments().until);
        const double distance = planner_->own().DistanceAt(time);
        if (!IsOpenRoad(town_->plan, lap, distance)) continue;
        mover.ride.ahead = lap.TimeAt(distance) - time;
        if (pace == Pace::kStanding) mover.ride.standing_at = distance;
        if (planner_->Add(std::move(mover))) break;
      }
    }
  }

  /// Adds a stream over the lap, one vehicle every `headway` seconds at density 1.
  void Stream(const Lap& lap, Pace pace, double headway) {
    const int slots = static_cast<int>(lap.duration() / headway);
    const double phase = random_.Uniform(0, headway);
    for (int slot = 0; slot < slots; ++slot) {
      if (!random_.Chance(density_)) continue;
      for (int i = 0; i < kTries; ++i) {
        Mover mover = Draw(lap, pace);
        mover.ride.ahead =
            lap.duration() / slots * slot + phase + (i == 0 ? 0 : random_.Uniform(-1, 1) * headway);
        if (planner_->Add(std::move(mover))) break;
      }
    }
  }

  void Walk(size_t street, std::vector<Walker>* walkers) {
    constexpr double kMetresPerPedestrian = 14;  // on either side, at density 1
    const double length = town_->plan.streets[street].Length();
    const int count = static_cast<int>(std::lround(2 * density_ * length / kMetresPerPedestrian));
    for (int k = 0; k < count; ++k) {
      for (int i = 0; i < kTries; ++i) {
        const Walker walker = DrawWalker(town_->plan, street, random_);
        if (!planner_->IsSafe(walker)) continue;
        walkers->push_back(walker);
        break;
      }
    }
  }

 private:
  Mover Draw(const Lap& lap, Pace pace) {
    Mover mover;
    mover.ride.lap = &lap;
    mover.pace = pace;
    mover.tint = DrawPaint(random_);
    if (pace == Pace::kCycling) {
      mover.ride.from_kerb = random_.Uniform(0.5, 0.75);
      mover.footprint = {kBicycleLength, kHandlebarWidth};
      mover.model = town_->cyclists[static_cast<size_t>(
          random_.Int(static_cast<int>(town_->cyclists.size())))];
      return mover;
    }
    const VehicleKind drawn = DrawVehicleKind(random_);
    const bool is_van = pace == Pace::kStanding || pace == Pace::kSlow;
    const bool is_car = pace == Pace::kFast && drawn == VehicleKind::kVan;
    const VehicleKind kind = is_van ? VehicleKind::kVan : is_car ? VehicleKind::kEstate : drawn;
    mover.footprint = {VehicleLength(kind), VehicleWidth(kind)};
    mover.model = town_->vehicles[static_cast<size_t>(kind)];
    if (pace == Pace::kStanding) mover.ride.from_kerb = 0.5 * mover.footprint.width + 0.1;
    return mover;
  }

  const Town* town_;
  double density_;
  TrafficPlanner* planner_;
  Random random_;
};

}  // namespace

Traffic::Traffic(const Town& town, const Lap& own_lap, const TrafficOptions& options)
    : town_(&town), own_{.lap = &own_lap} {
  if (options.density <= 0) return;
  const StreetPlan& plan = town.plan;
  TrafficPlanner planner(plan, own_lap, {options.from, options.until});
  Dispatcher dispatcher(town, options, &planner);
  uint64_t number = 0;
  const auto add_lap = [&](const std::vector<size_t>& tour, const LapOptions& style) -> const Lap& {
    LapOptions lap_options = style;
    lap_options.seed = Random(options.seed).Fork(++number).Next();
    return laps_.emplace_back(plan, tour, lap_options);
  };
  const LapOptions normal;
  const LapOptions cycling{.minimum_speed = 3.6, .maximum_speed = 5.2, .stop_fraction = 0.05};
  const LapOptions slow{.minimum_speed = 4, .maximum_speed = 6, .stop_fraction = 0.1};
  const LapOptions fast{.minimum_speed = 11, .maximum_speed = 14, .stop_fraction = 0};
  dispatcher.Encounter(own_lap, Pace::kStanding, 40);
  dispatcher.Encounter(add_lap(plan.tour, cycling), Pace::kCycling, 16);
  dispatcher.Encounter(add_lap(plan.tour, slow), Pace::kSlow, 50);
  dispatcher.Encounter(add_lap(plan.tour, fast), Pace::kFast, 35);
  constexpr double kHeadway = 5.5;  // seconds
  dispatcher.Stream(own_lap, Pace::kNormal, kHeadway);
  const std::vector<size_t> reversed(plan.tour.rbegin(), plan.tour.rend());
  dispatcher.Stream(add_lap(reversed, normal), Pace::kNormal, kHeadway);
  for (const std::vector<size_t>& tour : plan.other_tours)
    dispatcher.Stream(add_lap(tour, normal), Pace::kNormal, kHeadway);
  dispatcher.Stream(add_lap(reversed, cycling), Pace::kCycling, 6 * kHeadway);
  for (const std::vector<size_t>& tour : plan.other_tours)
    dispatcher.Stream(add_lap(tour, cycling), Pace::kCycling, 8 * kHeadway);
  for (size_t i = 0; i < plan.streets.size(); ++i) dispatcher.Walk(i, &walkers_);
  Random random = Random(options.seed).Fork(0);
  for (size_t i = 0; i < walkers_.size(); ++i) {
    walker_models_.push_back(town.pedestrians[static_cast<size_t>(
        random.Int(static_cast<int>(town.pedestrians.size())))]);
  }
  own_ = planner.own();
  movers_ = planner.Others();
}

Instance Traffic::Place(const Mover& mover, double time) const {
  const RoadPose pose = mover.ride.PoseAt(time);
  Instance instance;
  instance.model = mover.model;
  if (mover.pace == Pace::kCycling) {
    const double turns = mover.ride.DistanceAt(time) / kMetresPerPedalTurn;
    instance.model +=
        static_cast<uint32_t>((turns - std::floor(turns)) * kPedalPhases) % kPedalPhases;
  }
  instance.tint = mover.tint;
  instance.openness = 0.7F;
  instance.world_from_model =
      Eigen::Translation3f(
          Eigen::Vector3d(pose.position.x(), pose.position.y(), pose.height).cast<float>()) *
      Eigen::AngleAxisf(static_cast<float>(std::atan2(pose.forward.y(), pose.forward.x())),
                        Vector3f::UnitZ()) *
      Eigen::AngleAxisf(static_cast<float>(-pose.slope), Vector3f::UnitY()) *
      Eigen::AngleAxisf(static_cast<float>(pose.bank), Vector3f::UnitX());
  return instance;
}

Instance Traffic::Place(size_t walker, double time) const {
  const Walker::State state = walkers_[walker].At(town_->plan, time);
  const double kerb =
      std::clamp(town_->plan.DistanceToRoad(state.position) / 0.2, 0.0, 1.0) * kKerbHeight;
  const double stride = std::abs(state.walked) / kStrideLength;
  const auto phase =
      static_cast<uint32_t>((stride - std::floor(stride)) * kWalkPhases) % kWalkPhases;
  Instance instance;
  instance.model = walker_models_[walker] + phase;
  instance.openness = 0.8F;
  instance.world_from_model =
      Eigen::Translation3f(Eigen::Vector3d(state.position.x(), state.position.y(),
                                           town_->plan.Height(state.position) + kerb)
                               .cast<float>()) *
      Eigen::AngleAxisf(static_cast<float>(std::atan2(state.forward.y(), state.forward.x())),
                        Vector3f::UnitZ());
  return instance;
}

std::vector<Instance> Traffic::At(double time) const {
  std::vector<Instance> instances;
  for (const Mover& mover : movers_) instances.push_back(Place(mover, time));
  for (size_t i = 0; i < walkers_.size(); ++i) instances.push_back(Place(i, time));
  return instances;
}

}  // namespace orb360::town
