#include "apps/town/drive/traffic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/town/image/random.h"
#include "apps/town/world/ground.h"
#include "apps/town/world/pedestrian.h"
#include "apps/town/world/vehicle.h"

namespace orb360::town {

Traffic::Traffic(const Town& town, const Lap& own_lap, const Lap& oncoming_lap,
                 const TrafficOptions& options)
    : town_(&town) {
  if (options.density <= 0) return;
  cars_.push_back({&own_lap, 0, 0, {}});  // the camera's, while the others are drawn
  AddCars(own_lap, options, Hash(options.seed ^ 1));
  AddCars(oncoming_lap, options, Hash(options.seed ^ 2));
  cars_.erase(cars_.begin());
  Random random(Hash(options.seed ^ 3));
  for (size_t i = 0; i < town.plan.streets.size(); ++i) {
    const Street& street = town.plan.streets[i];
    constexpr double kMetresPerPedestrian = 14;  // on either side, at density 1
    const int count =
        static_cast<int>(std::lround(2 * options.density * street.Length() / kMetresPerPedestrian));
    for (int k = 0; k < count; ++k) {
      Pedestrian pedestrian;
      pedestrian.street = i;
      pedestrian.side = random.Chance(0.5) ? 1 : -1;
      pedestrian.from_kerb = random.Uniform(1.0, std::max(1.1, street.pavement - 0.4));
      pedestrian.start = random.Uniform(0, street.Length());
      pedestrian.speed = (random.Chance(0.5) ? 1 : -1) * random.Uniform(0.9, 1.7);
      pedestrian.first_model = town.pedestrians[static_cast<size_t>(
          random.Int(static_cast<int>(town.pedestrians.size())))];
      pedestrian.tint = {1, 1, 1, 1};
      pedestrians_.push_back(pedestrian);
    }
  }
}

void Traffic::AddCars(const Lap& lap, const TrafficOptions& options, uint64_t seed) {
  Random random(seed);
  // Shorter headways would let the next car run into one that waits at a junction.
  constexpr double kHeadway = 6.5;  // seconds
  const int slots = static_cast<int>(lap.duration() / kHeadway);
  for (int slot = 0; slot < slots; ++slot) {
    const double offset = lap.duration() / slots * slot + random.Uniform(0, 0.6);
    const bool is_taken = random.Chance(options.density);
    const int kind = random.Chance(0.15) ? 3 : random.Int(3);
    const Car car{&lap, offset, town_->vehicles[static_cast<size_t>(kind)], DrawPaint(random)};
    if (!is_taken) continue;
    if (std::none_of(cars_.begin(), cars_.end(),
                     [&](const Car& other) { return Collide(car, other, options); }))
      cars_.push_back(car);
  }
}

bool Traffic::Collide(const Car& a, const Car& b, const TrafficOptions& options) const {
  // A car is three discs in a row, with some air around them.
  constexpr double kRadius = 1.15;                          // metres
  constexpr std::array<double, 3> kDiscs = {-1.7, 0, 1.7};  // metres along the car
  constexpr double kStep = 0.2;                             // seconds
  constexpr double kFarApart = 2 * (kRadius + kDiscs.back());
  for (double time = options.from; time <= options.until; time += kStep) {
    const RoadPose p = a.lap->PoseAt(a.lap->At(time + a.offset).station);
    const RoadPose q = b.lap->PoseAt(b.lap->At(time + b.offset).station);
    if ((p.position - q.position).norm() > kFarApart) continue;
    for (const double x : kDiscs) {
      for (const double y : kDiscs) {
        if ((p.position + x * p.forward - q.position - y * q.forward).norm() < 2 * kRadius)
          return true;
      }
    }
  }
  return false;
}

Instance Traffic::Place(const Car& car, double time) const {
  const RoadPose pose = car.lap->PoseAt(car.lap->At(time + car.offset).station);
  Instance instance;
  instance.model = car.model;
  instance.tint = car.tint;
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

Instance Traffic::Place(const Pedestrian& pedestrian, double time) const {
  const Street& street = town_->plan.streets[pedestrian.street];
  const double walked = pedestrian.speed * time;
  const double length = street.Length();
  const double station =
      pedestrian.start + walked - length * std::floor((pedestrian.start + walked) / length);
  const StreetPoint p = street.At(station);
  const Vector2d outward = pedestrian.side * Vector2d(-p.tangent.y(), p.tangent.x());
  const Vector2d position = p.position + (p.half_width + pedestrian.from_kerb) * outward;
  const Vector2d forward = pedestrian.speed > 0 ? p.tangent : Vector2d(-p.tangent);
  const double kerb =
      std::clamp(town_->plan.DistanceToRoad(position) / 0.2, 0.0, 1.0) * kKerbHeight;
  const double stride = std::abs(walked) / kStrideLength;
  const auto phase =
      static_cast<uint32_t>((stride - std::floor(stride)) * kWalkPhases) % kWalkPhases;
  Instance instance;
  instance.model = pedestrian.first_model + phase;
  instance.tint = pedestrian.tint;
  instance.openness = 0.8F;
  instance.world_from_model =
      Eigen::Translation3f(
          Eigen::Vector3d(position.x(), position.y(), town_->plan.Height(position) + kerb)
              .cast<float>()) *
      Eigen::AngleAxisf(static_cast<float>(std::atan2(forward.y(), forward.x())),
                        Vector3f::UnitZ());
  return instance;
}

std::vector<Instance> Traffic::At(double time) const {
  std::vector<Instance> instances;
  for (const Car& car : cars_) instances.push_back(Place(car, time));
  for (const Pedestrian& pedestrian : pedestrians_) instances.push_back(Place(pedestrian, time));
  return instances;
}

}  // namespace orb360::town
