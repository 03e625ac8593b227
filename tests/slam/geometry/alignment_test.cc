#include "slam/geometry/alignment.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Vector3d;

template <typename Transform>
std::vector<Vector3d> Apply(const Transform& transform, const std::vector<Vector3d>& points) {
  std::vector<Vector3d> result;
  for (const Vector3d& point : points) result.push_back(transform * point);
  return result;
}

template <typename Transform>
double Cost(const Transform& transform, const std::vector<Vector3d>& source,
            const std::vector<Vector3d>& target) {
  double cost = 0.0;
  for (size_t i = 0; i < source.size(); ++i) {
    cost += (transform * source[i] - target[i]).squaredNorm();
  }
  return cost;
}

Vector3d Centroid(const std::vector<Vector3d>& points) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

std::vector<Vector3d> RandomPoints(int count, RandomGeometry* random) {
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) points.push_back(random->Point(0.0, 10.0));
  return points;
}

TEST(Alignment, RecoversTheExactTransform) {
  RandomGeometry random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<Vector3d> source = RandomPoints(3 + trial % 20, &random);
    const Rigid3 rigid = random.Transform();
    const auto found_rigid = AlignRigid(source, Apply(rigid, source));
    ASSERT_TRUE(found_rigid);
    EXPECT_LT(LogSo3(found_rigid->rotation.conjugate() * rigid.rotation).norm(), 1e-9);
    EXPECT_LT(Cost(*found_rigid, source, Apply(rigid, source)), 1e-20);
    const Similarity3 similarity = random.Similarity();
    const auto found = AlignSimilarity(source, Apply(similarity, source));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->scale, similarity.scale, 1e-12);
    EXPECT_LT(LogSo3(found->rotation.conjugate() * similarity.rotation).norm(), 1e-9);
    EXPECT_LT(Cost(*found, source, Apply(similarity, source)), 1e-20);
  }
}

TEST(Alignment, NoNearbyTransformIsBetterOnNoisyPoints) {
  RandomGeometry random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<Vector3d> source = RandomPoints(30, &random);
    std::vector<Vector3d> target = Apply(random.Similarity(), source);
    for (Vector3d& point : target) point += random.Point(0.0, 1.0);
    const auto rigid = AlignRigid(source, target);
    const auto similarity = AlignSimilarity(source, target);
    ASSERT_TRUE(rigid && similarity);
    const double rigid_cost = Cost(*rigid, source, target);
    const double similarity_cost = Cost(*similarity, source, target);
    EXPECT_LE(similarity_cost, rigid_cost);
    for (int other = 0; other < 50; ++other) {
      const double reach = std::pow(10.0, random.Uniform(-4.0, 0.0));
      const Rigid3 nudge{random.Rotation(reach), random.Point(0.0, reach)};
      EXPECT_GE(Cost(nudge * *rigid, source, target), rigid_cost * (1 - 1e-12));
      const Similarity3 scaled{std::exp(random.Uniform(-reach, reach)), nudge.rotation,
                               nudge.translation};
      EXPECT_GE(Cost(scaled * *similarity, source, target), similarity_cost * (1 - 1e-12));
    }
  }
}

TEST(Alignment, PlanarPointsAreNotReflected) {
  RandomGeometry random(3);
  std::vector<Vector3d> source = RandomPoints(20, &random);
  for (Vector3d& point : source) point.z() = 0.0;
  const Similarity3 truth = random.Similarity();
  const auto found = AlignSimilarity(source, Apply(truth, source));
  ASSERT_TRUE(found);
  EXPECT_LT(LogSo3(found->rotation.conjugate() * truth.rotation).norm(), 1e-9);
}

TEST(AlignSimilarity, APointWithAWeightCountsAsThatManyPoints) {
  RandomGeometry random(17);
  std::vector<Vector3d> source;
  std::vector<Vector3d> target;
  std::vector<double> weights;
  std::vector<Vector3d> repeated_source;
  std::vector<Vector3d> repeated_target;
  for (int i = 0; i < 12; ++i) {
    source.push_back(random.Point(1.0, 5.0));
    target.push_back(2.0 * source.back() + random.Point(0.0, 0.5));
    weights.push_back(1.0 + i % 3);
    repeated_source.insert(repeated_source.end(), 1 + i % 3, source.back());
    repeated_target.insert(repeated_target.end(), 1 + i % 3, target.back());
  }
  const Similarity3 weighted = AlignSimilarity(source, target, weights).value();
  const Similarity3 repeated = AlignSimilarity(repeated_source, repeated_target).value();
  EXPECT_NEAR(weighted.scale, repeated.scale, 1e-12);
  EXPECT_LT(weighted.rotation.angularDistance(repeated.rotation), 1e-7);
  EXPECT_LT((weighted.translation - repeated.translation).norm(), 1e-11);
  EXPECT_GT(std::abs(weighted.scale - AlignSimilarity(source, target)->scale), 1e-4);
}

TEST(Alignment, MirroredPointsGetTheBestProperRotation) {
  RandomGeometry random(4);
  std::vector<Vector3d> source = RandomPoints(200, &random), target = source;
  for (Vector3d& point : source) point.z() *= 0.1;  // mirroring the thin axis costs least
  for (size_t i = 0; i < source.size(); ++i) target[i] = source[i].cwiseProduct(Vector3d(1, 1, -1));
  const auto found = AlignRigid(source, target);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
  EXPECT_LT(LogSo3(found->rotation).norm(), 0.1);

  const auto similarity = AlignSimilarity(source, target);
  ASSERT_TRUE(similarity);
  for (const double factor : {0.99, 1.01}) {
    Similarity3 other = *similarity;  // about the centroid
    other.scale *= factor;
    other.translation = Centroid(target) - other.scale * (other.rotation * Centroid(source));
    EXPECT_GT(Cost(other, source, target), Cost(*similarity, source, target));
  }
}

TEST(Alignment, StraightPathsAlignWithTheSmallestTurn) {
  const Vector3d direction = Vector3d(1, 2, 3).normalized();
  std::vector<Vector3d> source, target;
  for (int i = 0; i < 50; ++i) {
    source.push_back(Vector3d(5, 6, 7) + 0.4 * i * direction);
    target.push_back(Vector3d(-1, 0, 2) + 0.8 * i * Vector3d::UnitX());
  }
  const auto similarity = AlignSimilarity(source, target);
  ASSERT_TRUE(similarity);
  EXPECT_NEAR(similarity->scale, 2.0, 1e-12);
  EXPECT_LT(Cost(*similarity, source, target), 1e-20);
  const Vector3d turn = LogSo3(similarity->rotation);
  EXPECT_NEAR(turn.norm(), std::acos(direction.x()), 1e-9);
  EXPECT_NEAR(turn.dot(direction), 0.0, 1e-9);

  const auto unturned = AlignRigid(source, source);
  ASSERT_TRUE(unturned);
  EXPECT_LT(LogSo3(unturned->rotation).norm(), 1e-9);

  // Written with a micrometre of rounding it is the same line.
  std::vector<Vector3d> rounded = source;
  for (Vector3d& point : rounded) point = (point * 1e6).array().round() / 1e6;
  EXPECT_LT(LogSo3(AlignRigid(rounded, rounded)->rotation).norm(), 1e-9);
}

TEST(Alignment, StraightPathsInOppositeDirectionsAlign) {
  std::vector<Vector3d> source, target;
  for (int i = 0; i < 10; ++i) {
    source.emplace_back(i, 0, 0);
    target.emplace_back(-i, 0, 0);
  }
  const auto found = AlignRigid(source, target);
  ASSERT_TRUE(found);
  EXPECT_LT(Cost(*found, source, target), 1e-20);
  EXPECT_NEAR(LogSo3(found->rotation).norm(), std::numbers::pi, 1e-9);
}

TEST(Alignment, TwoPointsAreAStraightPath) {
  const std::vector<Vector3d> source = {{0, 0, 0}, {1, 0, 0}}, target = {{1, 1, 1}, {1, 3, 1}};
  const auto found = AlignSimilarity(source, target);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, 2.0, 1e-12);
  EXPECT_LT(Cost(*found, source, target), 1e-20);
}

TEST(Alignment, ASinglePlaceIsMovedButHasNoScale) {
  // Thirteen times these values, the means are off by rounding.
  const std::vector<Vector3d> here(13, Vector3d(0.1, 1e6 / 3.0, 0.7));
  const std::vector<Vector3d> there(13, Vector3d(-0.3, 1e5 / 3.0, 0.7));
  std::vector<Vector3d> apart;
  for (int i = 0; i < 13; ++i) apart.emplace_back(i, 0, 0);
  const auto moved = AlignRigid(here, there);
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->rotation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  EXPECT_LT((*moved * here[0] - there[0]).norm(), 1e-9);
  EXPECT_TRUE(AlignRigid(apart, there));
  EXPECT_FALSE(AlignSimilarity(here, there));
  EXPECT_FALSE(AlignSimilarity(here, apart));
  EXPECT_FALSE(AlignSimilarity(apart, here));
}

TEST(Alignment, KeepsItsDigitsFarFromTheOrigin) {
  RandomGeometry random(5);
  std::vector<Vector3d> source = RandomPoints(50, &random), target;
  const Rigid3 truth = random.Transform();
  const Vector3d utm(4e5, 5e6, 100);  // metres
  for (const Vector3d& point : source) target.push_back(truth * point + utm);
  const auto found = AlignRigid(source, target);
  ASSERT_TRUE(found);
  EXPECT_LT(LogSo3(found->rotation.conjugate() * truth.rotation).norm(), 1e-9);
}

TEST(Alignment, GivesNothingWithoutFinitePoints) {
  EXPECT_FALSE(AlignRigid({}, {}));
  EXPECT_FALSE(AlignSimilarity({}, {}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vector3d> good = {{0, 0, 0}, {1, 0, 0}}, bad = {{0, 0, 0}, {1, nan, 0}};
  EXPECT_FALSE(AlignRigid(good, bad));
  EXPECT_FALSE(AlignSimilarity(bad, good));
  EXPECT_THROW(AlignRigid(good, {}), ContractError);
}

}  // namespace
}  // namespace orb360
