#include "slam/optimization/bundle_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "slam/geometry/so3.h"

namespace orb360 {
namespace {

BundlePlaces PlacesOf(const BundleEstimate& estimate) {
  BundlePlaces places;
  places.poses.reserve(12 * estimate.camera_from_world.size());
  for (const Rigid3& pose : estimate.camera_from_world) {
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) places.poses.push_back(rotation(row, column));
      places.poses.push_back(pose.translation[row]);
    }
  }
  places.points.reserve(3 * estimate.points.size());
  for (const Eigen::Vector3d& point : estimate.points) {
    places.points.insert(places.points.end(), {point.x(), point.y(), point.z()});
  }
  return places;
}

// Lists the pairs of a moving pose and a point that have terms in common, and names them there.
BundleLinks LinkTerms(const std::vector<int>& moving, size_t num_points,
                      std::array<BundleTerms, 3>* all) {
  std::vector<std::vector<int>> poses(num_points);
  for (const BundleTerms& terms : *all) {
    for (size_t i = 0; i < terms.size; ++i) {
      const int pose = moving[terms.pose[i]];
      if (pose >= 0) poses[terms.point[i]].push_back(pose);
    }
  }
  BundleLinks links;
  for (std::vector<int>& of_point : poses) {
    std::ranges::sort(of_point);
    of_point.erase(std::ranges::unique(of_point).begin(), of_point.end());
    links.pose.insert(links.pose.end(), of_point.begin(), of_point.end());
    links.first.push_back(links.pose.size());
  }
  for (BundleTerms& terms : *all) {
    for (size_t i = 0; i < terms.size; ++i) {
      const int pose = moving[terms.pose[i]];
      if (pose < 0) continue;
      const std::vector<int>& of_point = poses[terms.point[i]];
      const auto place = std::ranges::lower_bound(of_point, pose) - of_point.begin();
      terms.link[i] = static_cast<int>(links.first[terms.point[i]]) + static_cast<int>(place);
    }
  }
  return links;
}

}  // namespace

BundleModel::BundleModel(const BundleOptions& options, const BundleProblem& problem)
    : terms_(MakeBundleTerms(problem)), direction_loss_(MakeBearingLoss(options.loss)) {
  for (const uint8_t is_fixed : problem.pose_fixed)
    moving_.push_back(is_fixed ? -1 : num_moving_++);
  links_ = LinkTerms(moving_, problem.points.size(), &terms_);
  structure_ = ReducedStructure(num_moving_, links_);
}

const ceres::LossFunction* BundleModel::LossOf(BundleTerms::Kind kind) const {
  if (kind == BundleTerms::kDirection) return direction_loss_.get();
  return kind == BundleTerms::kRange ? &range_loss_ : nullptr;
}

double BundleModel::Evaluate(const BundleEstimate& estimate, NormalEquations* equations) const {
  constexpr size_t kBlock = 16 * kMostTerms;  // rows of 24 KB: small enough for the first cache
  const BundlePlaces places = PlacesOf(estimate);
  std::vector<double> squared(kBlock);
  std::vector<double> weights(kBlock);
  std::vector<TermRow> rows(equations == nullptr ? 0 : 2 * kBlock);
  double cost = 0;
  for (const BundleTerms& terms : terms_) {
    const ceres::LossFunction* loss = LossOf(terms.kind);
    for (size_t begin = 0; begin < terms.size; begin += kBlock) {
      const size_t count = std::min(kBlock, terms.size - begin);
      EvaluateTerms(terms, begin, places,
                    std::span(squared).first((count + kMostTerms - 1) / kMostTerms * kMostTerms),
                    rows);
      for (size_t i = 0; i < count; ++i) {
        if (!std::isfinite(squared[i])) return std::numeric_limits<double>::infinity();
        // A robust loss counts like a weight that is its slope (all of them bend downward).
        double value[3] = {squared[i], 1, 0};
        if (loss != nullptr) loss->Evaluate(squared[i], value);
        cost += 0.5 * value[0];
        weights[i] = value[1];
      }
      if (equations != nullptr) {
        equations->Add(links_, terms, begin, rows, std::span(weights).first(count));
      }
    }
  }
  return cost;
}

double BundleModel::Cost(const BundleEstimate& estimate) const {
  return Evaluate(estimate, nullptr);
}

double BundleModel::Linearize(const BundleEstimate& estimate, NormalEquations* equations) const {
  equations->Clear(num_moving_, links_);
  return Evaluate(estimate, equations);
}

BundleEstimate BundleModel::Moved(const BundleEstimate& estimate, const BundleStep& step) const {
  BundleEstimate moved = estimate;
  for (size_t i = 0; i < moving_.size(); ++i) {
    if (moving_[i] < 0) continue;
    const PoseVector& d = step.poses[moving_[i]];
    moved.camera_from_world[i] =
        Rigid3{ExpSo3(d.head<3>()), d.segment<3>(3)} * moved.camera_from_world[i];
  }
  for (size_t p = 0; p < moved.points.size(); ++p) moved.points[p] += step.points[p];
  return moved;
}

}  // namespace orb360
