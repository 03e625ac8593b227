#include "slam/pipeline/panoramic_triangulation.h"

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

// The point whose descriptor a landmark carries.
int PointOf(const SyntheticScene& scene, const Landmark& landmark) {
  for (size_t i = 0; i < scene.points.size(); ++i) {
    if (scene.points[i].descriptor == landmark.descriptor) return static_cast<int>(i);
  }
  return -1;
}

TEST(PanoramicTriangulation, FindsTheRemainingPointsAllAroundWhereTheyAre) {
  SyntheticScene scene(600);
  Map map = scene.MakeMap(Walk(2, {-0.8, 0.3, 0.1}), 50, /*noise=*/0.0);
  const std::vector<LandmarkId> created = TriangulateNewLandmarks(1, {}, &map);
  EXPECT_GT(created.size(), 350u);
  for (const LandmarkId id : created) {
    const int point = PointOf(scene, map.landmark(id));
    ASSERT_GE(point, 50);
    EXPECT_LT((map.landmark(id).position - scene.points[point].position).norm(), 1e-6);
    EXPECT_EQ(map.landmark(id).observations.size(), 2u);
  }
  map.CheckConsistency();
}

TEST(PanoramicTriangulation, KeepsNoisyPointsWithinTheirExpectedError) {
  SyntheticScene scene(600);
  const std::vector<Rigid3> poses = Walk(2, {-0.8, 0.3, 0.1});
  Map map = scene.MakeMap(poses, 50);
  const std::vector<LandmarkId> created = TriangulateNewLandmarks(1, {}, &map);
  ASSERT_GT(created.size(), 200u);
  int within = 0;
  for (const LandmarkId id : created) {
    const SyntheticScene::Point& point = scene.points[PointOf(scene, map.landmark(id))];
    const Eigen::Vector3d to1 = point.position - poses[0].translation;
    const Eigen::Vector3d to2 = point.position - poses[1].translation;
    const double parallax = std::acos(to1.normalized().dot(to2.normalized()));
    const double level_sigma =
        map.keyframe(1).features->keypoints[map.landmark(id).observations[1].feature].sigma;
    const double range_sigma = to2.norm() * std::sqrt(2.0) * level_sigma / parallax;
    within += (map.landmark(id).position - point.position).norm() < 3.0 * range_sigma;
  }
  EXPECT_GT(within, 0.95 * static_cast<double>(created.size()));
}

TEST(PanoramicTriangulation, MakesNothingWithoutABaseline) {
  SyntheticScene scene(300);
  Map map = scene.MakeMap({Rigid3(), {ExpSo3({0.1, 0.2, 0.3}), {0.001, 0, 0}}}, 50);
  EXPECT_TRUE(TriangulateNewLandmarks(1, {}, &map).empty());
}

TEST(PanoramicTriangulation, MakesNothingNearTheEpipoles) {
  SyntheticScene scene(600);
  const std::vector<Rigid3> poses = Walk(2, {-1.0, 0.0, 0.0});
  for (int i = 300; i < 600; ++i) {  // ahead and behind within 0.04 rad of the line of motion
    Eigen::Vector3d& p = scene.points[i].position;
    p = Eigen::Vector3d((i % 2 == 0 ? -1.0 : 1.0) * p.norm(), 0.02 * (i % 3 - 1), 0.02);
  }
  Map map = scene.MakeMap(poses, 50, /*noise=*/0.0);
  for (const LandmarkId id : TriangulateNewLandmarks(1, {}, &map)) {
    EXPECT_LT(PointOf(scene, map.landmark(id)), 300);
  }
}

TEST(PanoramicTriangulation, RefusesMatchesThatBreakTheEpipolarGeometry) {
  SyntheticScene scene(400);
  const std::vector<Rigid3> poses = Walk(2, {-0.8, 0.3, 0.1});
  Map map = scene.MakeMap(poses, 50, /*noise=*/0.0);
  // The same descriptors seen from elsewhere than the keyframe claims.
  Map moved;
  moved.AddKeyframe(0, 0.0, poses[0], map.keyframe(0).features);
  const Rigid3 elsewhere{ExpSo3({0.5, -0.4, 0.8}), {3.0, 2.0, -1.0}};
  moved.AddKeyframe(1, 0.1, poses[1], scene.See(elsewhere, 0.0));
  const LandmarkId shared = moved.AddLandmark(scene.points[0].position, {});
  moved.AddObservation(shared, 0, 0);
  moved.AddObservation(shared, 1, 0);
  moved.UpdateAppearance(shared);
  EXPECT_LT(TriangulateNewLandmarks(1, {}, &moved).size(), 8u);
}

// What is seen from `pose`, and after all of it every point again, a level coarser and beside
// itself by half a standard deviation.
std::shared_ptr<Features> SeeOnTwoLevels(const Rigid3& pose, SyntheticScene* scene) {
  std::shared_ptr<Features> features = scene->See(pose, 0.0);
  const int num_points = features->size();
  for (int i = 0; i < num_points; ++i) {
    Keypoint keypoint = features->keypoints[i];
    ++keypoint.level;
    keypoint.sigma *= static_cast<float>(std::exp2(0.25));
    const Eigen::Vector3d bearing = features->bearings[i];
    features->bearings.push_back(
        (bearing + 0.5 * keypoint.sigma * bearing.unitOrthogonal()).normalized());
    features->descriptors.push_back(features->descriptors[i]);
    features->colors.push_back(features->colors[i]);
    features->keypoints.push_back(keypoint);
  }
  IndexFeatures(features.get());
  return features;
}

TEST(PanoramicTriangulation, MakesOneLandmarkOfACornerThatIsSeenOnTwoLevels) {
  SyntheticScene scene(300);
  const std::vector<Rigid3> poses = Walk(2, {-0.8, 0.3, 0.1});
  Map once = scene.MakeMap(poses, 50, /*noise=*/0.0);
  const size_t num_created = TriangulateNewLandmarks(1, {}, &once).size();
  ASSERT_GT(num_created, 150u);

  Map map;
  for (int k = 0; k < 2; ++k)
    map.AddKeyframe(k, 0.1 * k, poses[k], SeeOnTwoLevels(poses[k], &scene));
  for (int i = 0; i < 50; ++i) {
    const LandmarkId id = map.AddLandmark(scene.points[i].position, {});
    // The point itself in one keyframe, its coarser copy in the other.
    map.AddObservation(id, 0, i);
    map.AddObservation(id, 1, 300 + i);
    map.UpdateAppearance(id);
  }
  const std::vector<LandmarkId> created = TriangulateNewLandmarks(1, {}, &map);
  std::vector<int> points;
  for (const LandmarkId id : created) {
    points.push_back(PointOf(scene, map.landmark(id)));
    EXPECT_GE(points.back(), 50);
  }
  std::ranges::sort(points);
  EXPECT_EQ(std::ranges::adjacent_find(points), points.end()) << "two landmarks of one point";
  EXPECT_GT(static_cast<double>(created.size()), 0.95 * static_cast<double>(num_created));
}

TEST(PanoramicTriangulation, MakesNoLandmarksOfWhatIsNoCorner) {
  SyntheticScene scene(300);
  const std::vector<Rigid3> poses = Walk(2, {-0.8, 0.3, 0.1});
  Map map = scene.MakeMap(poses, 50, /*noise=*/0.0);
  auto features = std::make_shared<Features>(*map.keyframe(0).features);
  for (int i = 150; i < 300; ++i) features->keypoints[i].score = 0;
  map.keyframe(0).features = std::move(features);
  const std::vector<LandmarkId> created = TriangulateNewLandmarks(1, {}, &map);
  EXPECT_GT(created.size(), 60u);
  for (const LandmarkId id : created) EXPECT_LT(PointOf(scene, map.landmark(id)), 150);
}

// Priors of keyframe 0 for the points that have no landmark: `factor` times the true range.
void SetPriors(const SyntheticScene& scene, double factor, Map* map) {
  Keyframe& keyframe = map->keyframe(0);
  for (const SyntheticScene::Point& point : scene.points) {
    const double range = (point.position - keyframe.world_from_camera.translation).norm();
    keyframe.range_priors.push_back({static_cast<float>(factor * range), 0.05F});
  }
}

TEST(PanoramicTriangulation, RefusesMatchesWhereTheRangeIsKnownToBeAnother) {
  SyntheticScene scene(400);
  const Map map = scene.MakeMap(Walk(2, {-0.8, 0.3, 0.1}), 50);
  const auto created_with = [&](double factor) {
    Map with_priors = map;
    SetPriors(scene, factor, &with_priors);
    return TriangulateNewLandmarks(1, {}, &with_priors).size();
  };
  Map plain = map;
  const size_t without = TriangulateNewLandmarks(1, {}, &plain).size();
  ASSERT_GT(without, 150u);
  EXPECT_GT(created_with(1.0), 0.97 * static_cast<double>(without));
  EXPECT_GT(created_with(1.1), 0.97 * static_cast<double>(without));
  EXPECT_LT(created_with(2.0), 0.1 * static_cast<double>(without));
}

TEST(PanoramicTriangulation, TellsRepeatedPatchesApartWhereTheRangeIsKnown) {
  SyntheticScene scene(400);
  const std::vector<Rigid3> poses = Walk(2, {-0.8, 0.3, 0.1});
  // Every other point looks like the one before it and is a match for it by epipolar geometry, as
  // if it were 8 m away; it is 20 m away.
  for (int i = 50; i < 400; i += 2) {
    const Eigen::Vector3d ray = scene.random.Bearing();
    SyntheticScene::Point& point = scene.points[i];
    point.position = poses[1].translation + 4 * ray;
    point.max_range = 6;
    const Eigen::Vector3d seeming = poses[1].translation + 8 * ray;
    scene.points[i + 1] = {
        poses[0].translation + 20 * (seeming - poses[0].translation).normalized(), point.descriptor,
        30};
  }
  Map map = scene.MakeMap(poses, 50, /*noise=*/0.0);
  Map with_priors = map;
  SetPriors(scene, 1.0, &with_priors);
  const size_t ambiguous = TriangulateNewLandmarks(1, {}, &map).size();
  const size_t told_apart = TriangulateNewLandmarks(1, {}, &with_priors).size();
  EXPECT_GT(told_apart, 100u);
  EXPECT_GT(told_apart, ambiguous + 50);
}

}  // namespace
}  // namespace orb360
