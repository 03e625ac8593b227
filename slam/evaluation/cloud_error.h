#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "slam/evaluation/trajectory_error.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A disc of the true surface.
struct Surfel {
  Eigen::Vector3f position;  // world of the ground truth, metres
  Eigen::Vector3f normal;    // unit
  float radius;              // metres: discs of neighbouring pixels overlap
  float range;               // from the camera that saw it
};

/// The true surface as seen by true depth images, thinned to one disc in each cube of 5 cm: the one
/// that was seen from nearest.
class TrueSurface {
 public:
  /// Adds the surface that one image sees up to 80 m away. `range` is CV_32FC1, metres, 0 for none.
  /// `excluded`, CV_8UC1 of the same size or empty, is not 0 at pixels that are ignored, such as
  /// moving objects.
  void Add(const cv::Mat& range, const cv::Mat& excluded, const Rigid3& world_from_camera);

  /// Returns the discs in a fixed order.
  std::vector<Surfel> TakeSurfels();

 private:
  struct Entry {
    std::array<int, 3> cell;
    Surfel surfel;
  };
  void Thin();

  std::vector<Entry> entries_;
  size_t thinned_ = 0;  // entries at the beginning that are in different cubes, in their order
};

/// Distances of a cloud from the true surface and of the surface from the cloud.
struct CloudErrors {
  /// Distances for which both fractions are computed, metres.
  static constexpr std::array<double, 2> kDistances = {0.10, 0.25};
  /// True surfaces up to this distance from a camera should be in the cloud, metres.
  static constexpr double kCompleteRange = 15.0;

  size_t points = 0;   // of the cloud that were compared
  size_t surfels = 0;  // of the truth, up to kCompleteRange
  /// Fraction of the points that are not farther from the surface.
  std::array<double, 2> accuracy{};
  /// Fraction of the surface that has a point not farther away.
  std::array<double, 2> completeness{};
  /// Median distance of points from the surface, metres; at most the largest of kDistances.
  double median_distance = 0.0;
};

/// Compares a cloud (metres, world of the truth) with the true surface. Of very large clouds every
/// n-th point is compared. Values are NaN where there is nothing to compare. Runs on `num_threads`
/// OpenMP threads; the result does not depend on how many.
CloudErrors CompareCloud(std::span<const Eigen::Vector3f> cloud, std::span<const Surfel> truth,
                         int num_threads = 1);

/// Transforms points of an estimate into the world of the truth, each by the error of the
/// estimate's nearest pose. The cloud is then judged by the surroundings of the camera, not by the
/// drift of the path, which the errors of the trajectory state. Contract: there is at least one
/// pair.
void AlignLocally(std::span<const PosePair> pairs, std::span<Eigen::Vector3f> points);

}  // namespace orb360
