#include "slam/optimization/bundle_adjustment.h"

#include <gtest/gtest.h>

#include "nn/base/statistics.h"
#include "slam/optimization/local_bundle_adjustment.h"
#include "tests/slam/map/true_ground_step.h"
#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

// Poses and points that explain all observations exactly; two fixed poses hold the gauge.
BundleProblem ExactProblem(RandomGeometry* random) {
  BundleProblem problem;
  for (int i = 0; i < 10; ++i) {
    problem.world_from_camera.push_back({random->Rotation(0.4), {0.4 * i, 0.1 * i, 0.02 * i * i}});
    problem.pose_fixed.push_back(i < 2);
  }
  for (int p = 0; p < 400; ++p) {
    problem.points.push_back(random->Point(3.0, 12.0));
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector3d local = problem.world_from_camera[i].Inverse() * problem.points[p];
      problem.observations.push_back({i, p, local.normalized(), 0.001});
    }
  }
  return problem;
}

TEST(BundleAdjustment, RestoresADisturbedMap) {
  RandomGeometry random(4);
  const BundleProblem truth = ExactProblem(&random);
  BundleProblem problem = truth;
  for (int i = 2; i < 10; ++i) {
    problem.world_from_camera[i] =
        problem.world_from_camera[i] * Rigid3{random.Rotation(0.02), random.Point(0.0, 0.05)};
  }
  for (Eigen::Vector3d& point : problem.points) point += random.Point(0.0, 0.1);
  const SolverReport report =
      SolveBundle({.max_iterations = 50, .function_tolerance = 1e-16}, &problem);
  ASSERT_TRUE(report.usable);
  EXPECT_LT(report.final_cost, 1e-9 * report.initial_cost);
  for (int i = 0; i < 10; ++i) {
    EXPECT_LT(
        (problem.world_from_camera[i].translation - truth.world_from_camera[i].translation).norm(),
        1e-6);
    EXPECT_LT(
        problem.world_from_camera[i].rotation.angularDistance(truth.world_from_camera[i].rotation),
        1e-6);
  }
  for (size_t p = 0; p < truth.points.size(); ++p) {
    EXPECT_LT((problem.points[p] - truth.points[p]).norm(), 1e-6);
  }
}

TEST(BundleAdjustment, GivesTheSameBitsTwice) {
  RandomGeometry random(5);
  BundleProblem problem = ExactProblem(&random);
  for (Eigen::Vector3d& point : problem.points) point += random.Point(0.0, 0.1);
  BundleProblem again = problem;
  SolveBundle({}, &problem);
  SolveBundle({}, &again);
  for (size_t p = 0; p < problem.points.size(); ++p) {
    ASSERT_EQ(problem.points[p], again.points[p]);
  }
}

TEST(BundleAdjustment, APointBehindItsBearingIsNoInlier) {
  BundleProblem problem;
  problem.world_from_camera = {Rigid3()};
  problem.pose_fixed = {1};
  problem.points = {{-3, 0, 0}};
  EXPECT_LT(SquaredResidual(problem, {0, 0, {-1, 0, 0}, 0.01}), 1e-20);
  EXPECT_TRUE(std::isinf(SquaredResidual(problem, {0, 0, {1, 0, 0}, 0.01})));
}

TEST(LocalBundleAdjustment, MovesTheNeighbourhoodAndNothingElse) {
  SyntheticScene scene(300);
  const std::vector<Rigid3> poses = Walk(8, {-0.3, 0.1, 0.0});
  Map map = scene.MakeMap(poses, 300);
  LocalBundleOptions options;
  options.max_keyframes = 3;
  map.keyframe(7).world_from_camera.translation += Eigen::Vector3d(0.05, -0.05, 0.03);
  const Map before = map;
  AdjustLocally(7, options, {}, &map);
  map.CheckConsistency();
  EXPECT_LT((map.keyframe(7).world_from_camera.translation - poses[7].translation).norm(), 0.01);
  int moved = 0;
  for (KeyframeId id = 0; id < 8; ++id) {
    moved += map.keyframe(id).world_from_camera.translation !=
             before.keyframe(id).world_from_camera.translation;
  }
  EXPECT_EQ(moved, 3);
}

TEST(LocalBundleAdjustment, RemovesObservationsThatAreWrong) {
  SyntheticScene scene(200);
  const std::vector<Rigid3> poses = Walk(5, {-0.3, 0.1, 0.0});
  Map map = scene.MakeMap(poses, 180);
  // Keyframe 2 takes feature 190 for landmark 20.
  map.RemoveObservation(20, 2);
  map.AddObservation(20, 2, 190);
  AdjustLocally(4, {}, {}, &map);
  map.CheckConsistency();
  EXPECT_EQ(map.keyframe(2).landmarks[190], kNoId);
  ASSERT_TRUE(map.HasLandmark(20));
  EXPECT_EQ(map.landmark(20).observations.size(), 4u);
}

TEST(LocalBundleAdjustment, AlignedBearingsCountInThePlaceOfCorners) {
  SyntheticScene scene(200);
  const std::vector<Rigid3> poses = Walk(5, {-0.3, 0.1, 0.0});
  const Map corners = scene.MakeMap(poses, 180);
  const auto error_of = [&](Map map) {
    AdjustLocally(4, {}, {}, &map);
    return (map.keyframe(4).world_from_camera.translation - poses[4].translation).norm();
  };
  Map aligned = corners;
  for (LandmarkId id = 0; id < 180; ++id) {
    for (Observation& o : aligned.landmark(id).observations) {
      const Rigid3 camera_from_world = poses[o.keyframe].Inverse();
      o.aligned_bearing =
          (camera_from_world * scene.points[id].position).normalized().cast<float>();
      o.aligned_sigma = 1e-5f;
    }
  }
  EXPECT_GT(error_of(corners), 1e-4);
  EXPECT_LT(error_of(aligned), 1e-6);
}

TEST(LocalBundleAdjustment, AnAlignmentThatIsWrongGoesAndItsCornerStays) {
  SyntheticScene scene(200);
  Map map = scene.MakeMap(Walk(5, {-0.3, 0.1, 0.0}), 180);
  Observation& wrong = map.landmark(20).observations[2];
  const Eigen::Vector3d corner = map.keyframe(2).features->bearings[20];
  wrong.aligned_bearing = (corner + 0.01 * corner.unitOrthogonal()).normalized().cast<float>();
  wrong.aligned_sigma = 1e-3f;
  AdjustLocally(4, {}, {}, &map);
  ASSERT_EQ(map.keyframe(2).landmarks[20], 20);
  EXPECT_EQ(map.landmark(20).observations[2].aligned_sigma, 0);
}

// Two keyframes close to each other, whose parallax says little of how far points are.
TEST(LocalBundleAdjustment, RoughRangesHelpWithPointsOfLittleParallax) {
  SyntheticScene scene(300, 6.0, 20.0);
  const std::vector<Rigid3> poses = Walk(4, {-0.08, 0.02, 0.0});
  Map plain = scene.MakeMap(poses, 300);
  for (LandmarkId id = 0; id < plain.landmark_end(); ++id) {
    plain.landmark(id).position *= scene.random.Uniform(0.8, 1.25);
  }
  // All ranges are too long by a half, and each by a few per cent in addition.
  Map with_ranges = plain;
  for (const KeyframeId id : with_ranges.KeyframeIds()) {
    Keyframe& keyframe = with_ranges.keyframe(id);
    for (const SyntheticScene::Point& point : scene.points) {
      const double range = (point.position - keyframe.world_from_camera.translation).norm();
      keyframe.range_priors.push_back(
          {static_cast<float>(1.5 * range * scene.random.Uniform(0.96, 1.04)), 0.05F});
    }
  }
  const auto median_error = [&](Map* map) {
    AdjustLocally(3, {.max_iterations = 30}, {}, map);
    std::vector<double> errors;
    for (LandmarkId id = 0; id < map->landmark_end(); ++id) {
      if (!map->HasLandmark(id)) continue;
      errors.push_back(
          std::abs(std::log(map->landmark(id).position.norm() / scene.points[id].position.norm())));
    }
    EXPECT_GT(errors.size(), 250u);
    return Median(errors);
  };
  const double without = median_error(&plain);
  EXPECT_LT(median_error(&with_ranges), 0.8 * without);
}

TEST(LocalBundleAdjustment, StepsOverTheGroundHoldTheMotionThatFarPointsDoNot) {
  SyntheticScene scene(300, 200.0, 400.0);
  const std::vector<Rigid3> poses = Walk(6, {-1.2, 0.1, 0.0});
  Map map = scene.MakeMap(poses, 300);
  const Eigen::Vector3d step = poses[5].translation - poses[4].translation;
  const auto error_after = [&](const Eigen::Vector3d& tracked, Map adjusted) {
    Eigen::Vector3d& last = adjusted.keyframe(5).world_from_camera.translation;
    last = poses[4].translation + tracked;
    AdjustLocally(5, {.max_iterations = 10}, KnownGround{Eigen::Vector3d::UnitZ(), 1.6}, &adjusted);
    return (last - adjusted.keyframe(4).world_from_camera.translation - step).head<2>().norm() /
           step.norm();
  };
  const Eigen::Vector3d too_short = 0.8 * step;
  const Eigen::Vector3d aside = ExpSo3({0, 0, 0.2}) * step;
  EXPECT_GT(error_after(too_short, map), 0.03) << "or there is nothing to hold";
  EXPECT_GT(error_after(aside, map), 0.03) << "or there is nothing to hold";
  map.keyframe(5).ground_steps.push_back(TrueGroundStep(4, poses[4], poses[5], 1.6));
  EXPECT_LT(error_after(too_short, map), 0.01);
  EXPECT_LT(error_after(aside, map), 0.01);
}

TEST(LocalBundleAdjustment, StepsOverTheGroundAlsoMoveTheFirstKeyframesOfASmallMap) {
  SyntheticScene scene(300, 200.0, 400.0);
  const std::vector<Rigid3> poses = Walk(4, {-1.2, 0.1, 0.0});
  Map map = scene.MakeMap(poses, 300);
  for (KeyframeId id = 1; id < 4; ++id) {
    map.keyframe(id).world_from_camera.translation -= 0.4 * poses[1].translation;  // all but one
    map.keyframe(id).ground_steps.push_back(TrueGroundStep(id - 1, poses[id - 1], poses[id], 1.6));
  }
  AdjustLocally(3, {.max_iterations = 20}, KnownGround{Eigen::Vector3d::UnitZ(), 1.6}, &map);
  for (KeyframeId id = 1; id < 4; ++id) {
    const double length = (map.PoseOf(id).translation - map.PoseOf(id - 1).translation).norm();
    EXPECT_NEAR(length / poses[1].translation.norm(), 1.0, 0.02) << id;
  }
}

TEST(LocalBundleAdjustment, GlobalAdjustmentBringsTheWholeMapToRest) {
  SyntheticScene scene(200);
  const std::vector<Rigid3> poses = Walk(5, {-0.3, 0.1, 0.0});
  Map map = scene.MakeMap(poses, 200);
  for (KeyframeId id = 1; id < 5; ++id) {
    map.keyframe(id).world_from_camera.translation += Eigen::Vector3d(0.02, 0.01 * id, -0.02);
  }
  AdjustGlobally(30, std::nullopt, 0.0, &map);
  // The scale is free: compared by the ratio of two distances.
  const auto distance = [&](const auto& at, int a, int b) { return (at(a) - at(b)).norm(); };
  const auto found = [&](int id) { return map.keyframe(id).world_from_camera.translation; };
  const auto truth = [&](int id) { return poses[id].translation; };
  EXPECT_NEAR(distance(found, 0, 2) / distance(found, 0, 4),
              distance(truth, 0, 2) / distance(truth, 0, 4), 0.01);
}

TEST(LocalBundleAdjustment, GlobalAdjustmentSetsTheScaleByTheHeightAtOnce) {
  SyntheticScene scene(400);
  for (int i = 0; i < 150; ++i) {
    scene.points[i].position = {scene.random.Uniform(-5, 5), scene.random.Uniform(-5, 5), -1.6};
  }
  const std::vector<Rigid3> poses = Walk(12, {-0.3, 0.1, 0.0});
  Map map = scene.MakeMap(poses, 400);
  const Eigen::Vector3d origin(7, -3, 5);
  map.Transform({1.05, Eigen::Quaterniond::Identity(), origin});
  AdjustGlobally(1, KnownGround{Eigen::Vector3d::UnitZ(), 1.6}, 0.02, &map);
  EXPECT_EQ(map.keyframe(0).world_from_camera.translation, origin);
  const double found = (map.keyframe(11).world_from_camera.translation - origin).norm();
  EXPECT_NEAR(found / poses[11].translation.norm(), 1.0, 0.002);
}

// As at the ends of a loop, where points that look alike have become one landmark.
TEST(LocalBundleAdjustment, GlobalAdjustmentIsNotBentByLandmarksThatAreTwoPoints) {
  SyntheticScene scene(500);
  for (int i = 0; i < 200; ++i) {
    scene.points[300 + i].position = scene.points[i].position + Eigen::Vector3d(0, 0, 0.2);
  }
  const std::vector<Rigid3> poses = Walk(12, {-0.3, 0.1, 0.0});
  Map map = scene.MakeMap(poses, 300);
  // Two thirds of what the last keyframes see is a window further up on the facade.
  for (LandmarkId id = 0; id < 200; ++id) {
    for (KeyframeId keyframe = 9; keyframe < 12; ++keyframe) {
      map.RemoveObservation(id, keyframe);
      map.AddObservation(id, keyframe, 300 + id);
    }
  }
  AdjustGlobally(5, std::nullopt, 0.0, &map);
  map.CheckConsistency();
  // The first keyframe is fixed, the scale is free.
  const double scale =
      map.keyframe(8).world_from_camera.translation.norm() / poses[8].translation.norm();
  for (KeyframeId id = 1; id < 12; ++id) {
    const Eigen::Vector3d& found = map.keyframe(id).world_from_camera.translation;
    EXPECT_LT((found / scale - poses[id].translation).norm(), 0.01) << id;
  }
}

}  // namespace
}  // namespace orb360
