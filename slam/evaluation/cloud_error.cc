#include "slam/evaluation/cloud_error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>

#include "nn/base/statistics.h"
#include "slam/depth/geometric_consistency.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kSurfelSpacing = 0.05;  // metres
constexpr double kMaxTrueRange = 80.0;   // metres
/// Larger discs of far and slanted surfaces would extend beyond edges.
constexpr float kMaxSurfelRadius = 0.15f;  // metres
/// Beyond this number every n-th element is compared: fractions of a million are known to a tenth
/// of a percent.
constexpr size_t kMaxCompared = 1'000'000;

std::array<int, 3> CellOf(const Eigen::Vector3f& position, float size) {
  return {static_cast<int>(std::floor(position.x() / size)),
          static_cast<int>(std::floor(position.y() / size)),
          static_cast<int>(std::floor(position.z() / size))};
}

/// Positions sorted by cubes of one size, to find those around a place.
class CellIndex {
 public:
  template <typename Position>
  CellIndex(size_t count, float size, const Position& position) : size_(size) {
    order_.reserve(count);
    for (size_t i = 0; i < count; ++i) order_.push_back({CellOf(position(i), size_), i});
    std::ranges::sort(order_);
  }

  /// Calls visit(index) for the elements in the cube of `place` and in the 26 around it.
  template <typename Visit>
  void VisitAround(const Eigen::Vector3f& place, const Visit& visit) const {
    const std::array<int, 3> centre = CellOf(place, size_);
    for (int x = centre[0] - 1; x <= centre[0] + 1; ++x) {
      for (int y = centre[1] - 1; y <= centre[1] + 1; ++y) {
        // Three cubes above each other are neighbours in the order.
        const Entry first{{x, y, centre[2] - 1}, 0};
        const Entry last{{x, y, centre[2] + 2}, 0};
        for (auto it = std::ranges::lower_bound(order_, first); it != order_.end() && *it < last;
             ++it) {
          visit(it->second);
        }
      }
    }
  }

 private:
  using Entry = std::pair<std::array<int, 3>, size_t>;
  float size_;
  std::vector<Entry> order_;
};

/// Returns the distance of a point from a disc.
float DistanceFrom(const Surfel& surfel, const Eigen::Vector3f& point) {
  const Eigen::Vector3f offset = point - surfel.position;
  const float height = surfel.normal.dot(offset);
  const float aside = std::sqrt(std::max(0.0f, offset.squaredNorm() - height * height));
  return std::hypot(height, std::max(0.0f, aside - surfel.radius));
}

size_t StepFor(size_t count) { return count / kMaxCompared + 1; }

/// The largest distance that is told from larger ones, metres: kRelativeDistance of kFarRange.
constexpr auto kFarthest =
    static_cast<float>(CloudErrors::kRelativeDistance * CloudErrors::kFarRange);
static_assert(CloudErrors::kDistances.back() <= kFarthest);

/// A point or a disc, and its distance from the other side, both in metres.
struct Compared {
  float range;
  float distance;
};

/// The fraction of those up to `max_range` whose distance is at most `distance` plus `relative`
/// times the range.
double FractionWithin(std::span<const Compared> all, double max_range, double distance,
                      double relative) {
  size_t count = 0;
  size_t within = 0;
  for (const Compared& one : all) {
    if (one.range > max_range) continue;
    ++count;
    if (one.distance <= distance + relative * one.range) ++within;
  }
  return static_cast<double>(within) / static_cast<double>(count);
}

CloudAgreement AgreementWithin(std::span<const Compared> points, std::span<const Compared> surfels,
                               double max_range, double distance, double relative) {
  CloudAgreement agreement;
  agreement.accuracy = FractionWithin(points, max_range, distance, relative);
  agreement.completeness = FractionWithin(surfels, max_range, distance, relative);
  const double sum = agreement.accuracy + agreement.completeness;
  agreement.f_score = sum > 0 ? 2 * agreement.accuracy * agreement.completeness / sum : sum;
  return agreement;
}

/// Distances of places from the nearest camera, each to the half of a cube's diagonal.
class CameraRanges {
 public:
  explicit CameraRanges(std::span<const Eigen::Vector3f> cameras) : cameras_(cameras) {}

  float operator()(const Eigen::Vector3f& place) {
    constexpr float kCell = 0.5f;  // metres
    const std::array<int, 3> cell = CellOf(place, kCell);
    const auto [found, is_new] = ranges_.try_emplace(cell, 0.0f);
    if (is_new) {
      const Eigen::Vector3f center =
          kCell * (Eigen::Vector3f(static_cast<float>(cell[0]), static_cast<float>(cell[1]),
                                   static_cast<float>(cell[2])) +
                   Eigen::Vector3f::Constant(0.5f));
      float nearest = std::numeric_limits<float>::infinity();
      for (const Eigen::Vector3f& camera : cameras_) {
        nearest = std::min(nearest, (camera - center).squaredNorm());
      }
      found->second = std::sqrt(nearest);
    }
    return found->second;
  }

 private:
  std::span<const Eigen::Vector3f> cameras_;
  std::map<std::array<int, 3>, float> ranges_;
};

}  // namespace

void TrueSurface::Add(const cv::Mat& range, const cv::Mat& excluded,
                      const Rigid3& world_from_camera) {
  ORB360_CHECK(range.type() == CV_32FC1, range.type());
  ORB360_CHECK(excluded.empty() || (excluded.type() == CV_8UC1 && excluded.size() == range.size()),
               excluded.type(), excluded.size(), range.size());
  const cv::Mat certain(range.size(), CV_32FC1, cv::Scalar(1.0));
  GeometricConsistencyOptions options;
  options.min_support = 0;
  const DepthView view({range, certain, {}}, world_from_camera, options.min_error);
  const SamplingOptions sampling{kSurfelSpacing, kMaxTrueRange,
                                 std::numeric_limits<double>::infinity()};
  const float pixel_angle = std::numbers::pi_v<float> / static_cast<float>(range.rows);
  for (const ConsistentPoint& point : FindConsistentPoints(view, {}, options, sampling)) {
    if (!excluded.empty() && excluded.at<std::uint8_t>(point.row, point.column) != 0) continue;
    const float distance = view.range(point.row, point.column);
    const Eigen::Vector3f ray = (world_from_camera.rotation.toRotationMatrix() *
                                 view.BearingOf(point.row, point.column).cast<double>())
                                    .cast<float>();
    // Half of the diagonal of the pixel on the surface.
    const float reach = distance * pixel_angle / std::max(-ray.dot(point.normal), 0.1f);
    const float radius =
        std::clamp(0.7f * reach, static_cast<float>(kSurfelSpacing), kMaxSurfelRadius);
    const Eigen::Vector3f position = point.position.cast<float>();
    entries_.push_back({CellOf(position, static_cast<float>(kSurfelSpacing)),
                        {position, point.normal, radius, distance}});
  }
  // Thinning when the number has doubled costs no more than one sort at the end.
  if (entries_.size() > 2 * thinned_ + 1'000'000) Thin();
}

void TrueSurface::Thin() {
  std::ranges::stable_sort(entries_, [](const Entry& a, const Entry& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.surfel.range < b.surfel.range;
  });
  // clang 14 cannot compile std::ranges::unique of GCC's library.
  const auto is_same_cell = [](const Entry& a, const Entry& b) { return a.cell == b.cell; };
  entries_.erase(std::unique(entries_.begin(), entries_.end(), is_same_cell), entries_.end());
  thinned_ = entries_.size();
}

std::vector<Surfel> TrueSurface::TakeSurfels() {
  Thin();
  std::vector<Surfel> surfels;
  surfels.reserve(entries_.size());
  for (const Entry& entry : entries_) surfels.push_back(entry.surfel);
  entries_.clear();
  thinned_ = 0;
  return surfels;
}

CloudErrors CompareCloud(std::span<const Eigen::Vector3f> cloud, std::span<const Surfel> truth,
                         std::span<const Eigen::Vector3f> cameras, int num_threads) {
  // The cubes are so wide that every disc that can be near enough is in a neighbouring cube.
  const CellIndex surface(truth.size(), kFarthest + kMaxSurfelRadius,
                          [&](size_t i) { return truth[i].position; });
  CameraRanges range_of(cameras);
  std::vector<const Eigen::Vector3f*> compared;
  std::vector<Compared> points;
  for (size_t i = 0; i < cloud.size(); i += StepFor(cloud.size())) {
    const float range = range_of(cloud[i]);
    if (!(range <= CloudErrors::kFarRange)) continue;
    compared.push_back(&cloud[i]);
    points.push_back({range, 2.0f * kFarthest});
  }
#pragma omp parallel for schedule(dynamic, 1024) num_threads(num_threads)
  for (size_t i = 0; i < points.size(); ++i) {
    surface.VisitAround(*compared[i], [&](size_t j) {
      points[i].distance = std::min(points[i].distance, DistanceFrom(truth[j], *compared[i]));
    });
  }

  const CellIndex index(cloud.size(), kFarthest, [&](size_t i) { return cloud[i]; });
  std::vector<const Surfel*> wanted;
  for (const Surfel& surfel : truth) {
    if (surfel.range <= CloudErrors::kFarRange) wanted.push_back(&surfel);
  }
  const size_t step = StepFor(wanted.size());
  std::vector<Compared> surfels((wanted.size() + step - 1) / step);
#pragma omp parallel for schedule(dynamic, 1024) num_threads(num_threads)
  for (size_t i = 0; i < surfels.size(); ++i) {
    const Surfel& surfel = *wanted[i * step];
    float nearest = 4.0f * kFarthest * kFarthest;
    index.VisitAround(surfel.position, [&](size_t j) {
      nearest = std::min(nearest, (cloud[j] - surfel.position).squaredNorm());
    });
    surfels[i] = {surfel.range, std::sqrt(nearest)};
  }

  CloudErrors errors;
  errors.points = points.size();
  errors.surfels = surfels.size();
  for (size_t i = 0; i < errors.within.size(); ++i) {
    errors.within[i] =
        AgreementWithin(points, surfels, CloudErrors::kNearRange, CloudErrors::kDistances[i], 0.0);
  }
  errors.within_relative =
      AgreementWithin(points, surfels, CloudErrors::kFarRange, 0.0, CloudErrors::kRelativeDistance);
  std::vector<float> near;
  for (const Compared& point : points) {
    if (point.range <= CloudErrors::kNearRange) near.push_back(point.distance);
  }
  errors.median_distance = std::numeric_limits<double>::quiet_NaN();
  if (!near.empty()) errors.median_distance = std::min(Median(near), kFarthest);
  return errors;
}

void AlignLocally(std::span<const PosePair> pairs, std::span<Eigen::Vector3f> points) {
  ORB360_CHECK(!pairs.empty());
  std::vector<Rigid3> truth_from_estimate;
  truth_from_estimate.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    truth_from_estimate.push_back(pair.truth_from_camera * pair.estimate_from_camera.Inverse());
  }
  // One pose is used for each cube of this size, metres; the drift within it is negligible.
  constexpr float kCell = 1.0f;
  std::map<std::array<int, 3>, size_t> nearest_of_cell;
  for (Eigen::Vector3f& point : points) {
    const std::array<int, 3> cell = CellOf(point, kCell);
    const auto [found, is_new] = nearest_of_cell.try_emplace(cell, size_t{0});
    if (is_new) {
      const Eigen::Vector3d centre(kCell * (cell[0] + 0.5), kCell * (cell[1] + 0.5),
                                   kCell * (cell[2] + 0.5));
      const auto nearest = std::ranges::min_element(pairs, {}, [&](const PosePair& pair) {
        return (pair.estimate_from_camera.translation - centre).squaredNorm();
      });
      found->second = static_cast<size_t>(nearest - pairs.begin());
    }
    point = (truth_from_estimate[found->second] * point.cast<double>()).cast<float>();
  }
}

}  // namespace orb360
