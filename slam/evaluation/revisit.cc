#include "slam/evaluation/revisit.h"

#include <algorithm>
#include <cmath>

namespace orb360 {
namespace {

constexpr double kSamePlace = 5;    // m
constexpr double kTravelled = 50;   // m
constexpr double kOtherPlace = 10;  // m: from there on a loop is wrong
constexpr double kSlack = 1;        // s
constexpr double kCosAcross = 0.5;  // of the angle between the ways the camera looks

Eigen::Vector3d Ahead(const StampedPose& pose) {
  return pose.world_from_camera.rotation * -Eigen::Vector3d::UnitX();
}

std::vector<double> Travelled(std::span<const StampedPose> truth) {
  std::vector<double> travelled(truth.size());
  for (size_t i = 1; i < truth.size(); ++i) {
    travelled[i] = travelled[i - 1] + (truth[i].world_from_camera.translation -
                                       truth[i - 1].world_from_camera.translation)
                                          .norm();
  }
  return travelled;
}

/// Returns the earlier pose nearest to pose i among those with enough travel between, or i if none
/// is at the same place.
size_t PlaceOf(std::span<const StampedPose> truth, std::span<const double> travelled, size_t i) {
  double nearest = kSamePlace;
  size_t place = i;
  for (size_t j = 0; j < i && travelled[i] - travelled[j] > kTravelled; ++j) {
    const double distance =
        (truth[i].world_from_camera.translation - truth[j].world_from_camera.translation).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    place = j;
  }
  return place;
}

TrueRevisit::Direction DirectionOf(const StampedPose& now, const StampedPose& before) {
  const double cosine = Ahead(now).dot(Ahead(before));
  if (cosine > kCosAcross) return TrueRevisit::Direction::kSame;
  return cosine < -kCosAcross ? TrueRevisit::Direction::kOpposite : TrueRevisit::Direction::kAcross;
}

const StampedPose& NearestInTime(std::span<const StampedPose> truth, double time) {
  return *std::ranges::min_element(
      truth, {}, [&](const StampedPose& pose) { return std::abs(pose.timestamp - time); });
}

bool IsRight(std::span<const StampedPose> truth, const LoopTimes& loop) {
  const StampedPose& now = NearestInTime(truth, loop.now);
  const StampedPose& before = NearestInTime(truth, loop.before);
  return (now.world_from_camera.translation - before.world_from_camera.translation).norm() <=
         kOtherPlace;
}

}  // namespace

std::vector<TrueRevisit> FindRevisits(std::span<const StampedPose> truth) {
  const std::vector<double> travelled = Travelled(truth);
  std::vector<size_t> places(truth.size());
  for (size_t i = 0; i < truth.size(); ++i) places[i] = PlaceOf(truth, travelled, i);
  std::vector<TrueRevisit> revisits;
  for (size_t i = 0; i < truth.size(); ++i) {
    if (places[i] == i) continue;
    size_t last = i;
    while (last + 1 < truth.size() && places[last + 1] != last + 1) ++last;
    const size_t middle = (i + last) / 2;
    revisits.push_back({truth[i].timestamp, truth[last].timestamp, travelled[last] - travelled[i],
                        DirectionOf(truth[middle], truth[places[middle]])});
    i = last;
  }
  return revisits;
}

LoopErrors CompareLoops(std::span<const StampedPose> truth, std::span<const LoopTimes> loops) {
  LoopErrors errors;
  if (truth.empty()) return errors;
  std::vector<LoopTimes> right;
  std::ranges::copy_if(loops, std::back_inserter(right),
                       [&](const LoopTimes& loop) { return IsRight(truth, loop); });
  errors.wrong = static_cast<int>(loops.size() - right.size());
  for (const TrueRevisit& revisit : FindRevisits(truth)) {
    ++errors.revisits;
    errors.closed += std::ranges::any_of(right, [&](const LoopTimes& loop) {
      return loop.now >= revisit.begin - kSlack && loop.now <= revisit.end + kSlack;
    });
  }
  return errors;
}

}  // namespace orb360
