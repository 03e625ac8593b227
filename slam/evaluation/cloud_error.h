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

/// How well a cloud and the true surface agree within a distance.
struct CloudAgreement {
  double accuracy = 0;      // fraction of the points that are not farther from the surface
  double completeness = 0;  // fraction of the surface that has a point not farther away
  /// The harmonic mean of both (Knapitsch et al., "Tanks and Temples", 2017).
  double f_score = 0;
};

/// Distances of a cloud from the true surface and of the surface from the cloud.
struct CloudErrors {
  /// Distances for which points and surfaces up to kNearRange from a camera are compared, metres.
  static constexpr std::array<double, 3> kDistances = {0.05, 0.10, 0.25};
  static constexpr double kNearRange = 15.0;
  /// Distance, as a fraction of the range, for which those up to kFarRange are compared.
  static constexpr double kRelativeDistance = 0.01;
  static constexpr double kFarRange = 30.0;

  size_t points = 0;   // of the cloud that were compared, up to kFarRange from a camera
  size_t surfels = 0;  // of the truth, up to kFarRange
  std::array<CloudAgreement, kDistances.size()> within{};
  CloudAgreement within_relative;
  /// Median distance of points up to kNearRange from the surface, metres; at most the largest
  /// distance that is distinguished, 0.3 m.
  double median_distance = 0.0;
};

/// Compares a cloud (metres, world of the truth) with the true surface. The range of a point is its
/// distance from the nearest of `cameras`. Of very large clouds every n-th point is compared.
/// Values are NaN where there is nothing to compare. Runs on `num_threads` OpenMP threads; the
/// result does not depend on how many.
CloudErrors CompareCloud(std::span<const Eigen::Vector3f> cloud, std::span<const Surfel> truth,
                         std::span<const Eigen::Vector3f> cameras, int num_threads = 1);

/// Transforms points of an estimate into the world of the truth, each by the error of the
/// estimate's nearest pose. The cloud is then judged by the surroundings of the camera, not by the
/// drift of the path, which the errors of the trajectory state. Contract: there is at least one
/// pair.
void AlignLocally(std::span<const PosePair> pairs, std::span<Eigen::Vector3f> points);

}  // namespace orb360
