#include <numbers>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(Rigid3, AppliesRotationThenTranslation) {
  const Rigid3 quarter_turn_left_and_up{
      Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ())), Vector3d(0, 0, 5)};
  EXPECT_LT((quarter_turn_left_and_up * Vector3d(1, 0, 0) - Vector3d(0, 1, 5)).norm(), 1e-15);
}

TEST(Rigid3, DefaultIsTheIdentity) {
  const Vector3d p(1, 2, 3);
  EXPECT_EQ(Rigid3() * p, p);
  EXPECT_EQ(Similarity3() * p, p);
}

TEST(Rigid3, ProductAppliesTheRightFactorFirst) {
  RandomGeometry random(1);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 a_from_b = random.Transform();
    const Rigid3 b_from_c = random.Transform();
    const Vector3d p = random.Point(0.1, 10.0);
    EXPECT_LT((a_from_b * b_from_c * p - a_from_b * (b_from_c * p)).norm(), 1e-13);
  }
}

TEST(Rigid3, InverseUndoesFromBothSides) {
  RandomGeometry random(2);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 t = random.Transform();
    const Vector3d p = random.Point(0.1, 10.0);
    EXPECT_LT((t.Inverse() * (t * p) - p).norm(), 1e-13);
    EXPECT_LT((t * (t.Inverse() * p) - p).norm(), 1e-13);
    EXPECT_LT((t * t.Inverse()).translation.norm(), 1e-13);
  }
}

TEST(Rigid3, LongChainsStayRotations) {
  RandomGeometry random(3);
  const Rigid3 step = random.Transform();
  Rigid3 chain;
  for (int i = 0; i < 100'000; ++i) chain = chain * step;
  EXPECT_NEAR(chain.rotation.norm(), 1.0, 1e-15);
}

TEST(Similarity3, ScalesRotatesThenTranslates) {
  const Similarity3 s{2.0, Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ())),
                      Vector3d(0, 0, 5)};
  EXPECT_LT((s * Vector3d(1, 0, 1) - Vector3d(0, 2, 7)).norm(), 1e-15);
}

TEST(Similarity3, ProductAndInverseAreThoseOfTheGroup) {
  RandomGeometry random(4);
  for (int i = 0; i < 100; ++i) {
    const Similarity3 a = random.Similarity();
    const Similarity3 b = random.Similarity();
    const Vector3d p = random.Point(0.1, 10.0);
    EXPECT_LT((a * b * p - a * (b * p)).norm(), 1e-12);
    EXPECT_LT((a.Inverse() * (a * p) - p).norm(), 1e-13);
    EXPECT_LT((a * (a.Inverse() * p) - p).norm(), 1e-12);
    EXPECT_NEAR((a * a.Inverse()).scale, 1.0, 1e-15);
  }
}

TEST(TransformPose, KeepsEveryPointOnItsRayWithItsRangeScaled) {
  RandomGeometry random(5);
  for (int i = 0; i < 100; ++i) {
    const Similarity3 target_from_world = random.Similarity();
    const Rigid3 world_from_camera = random.Transform();
    const Rigid3 target_from_camera = TransformPose(target_from_world, world_from_camera);
    const Vector3d in_world = random.Point(0.1, 10.0);
    const Vector3d before = world_from_camera.Inverse() * in_world;
    const Vector3d after = target_from_camera.Inverse() * (target_from_world * in_world);
    EXPECT_LT((after - target_from_world.scale * before).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace orb360
