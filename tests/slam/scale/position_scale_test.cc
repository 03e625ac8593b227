#include "slam/scale/position_scale.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kMetres = 2.5;  // in a unit of the map

// A drive of 200 s along a bend, with a point of the path each half second.
std::vector<PathPoint> Path() {
  std::vector<PathPoint> path;
  for (double t = 0; t <= 200; t += 0.5) {
    path.push_back({t, {60 * std::sin(t / 80), 60 * std::cos(t / 50), 0.5 * std::sin(t / 7)}});
  }
  return path;
}

// A fix every `period` seconds, in another frame, with errors that decay within `correlation`
// seconds.
std::vector<PositionFix> Receive(double period, double sigma, double correlation,
                                 RandomGeometry* random) {
  const Similarity3 receiver_from_map{kMetres, random->Rotation(), random->Point(10, 1000)};
  std::vector<PositionFix> fixes;
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  const double kept = correlation > 0 ? std::exp(-period / correlation) : 0.0;
  for (const PathPoint& point : Path()) {
    if (std::abs(std::remainder(point.timestamp, period)) > 0.1) continue;
    const Eigen::Vector3d fresh(random->Normal(sigma), random->Normal(sigma),
                                random->Normal(sigma));
    error =
        fixes.empty() ? fresh : Eigen::Vector3d(kept * error + std::sqrt(1 - kept * kept) * fresh);
    fixes.push_back({point.timestamp, receiver_from_map * point.position + error, sigma});
  }
  return fixes;
}

double MeanSquaredError(double period, double correlation) {
  double sum = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    RandomGeometry random(run);
    const auto measured =
        MeasureScaleByPositions(Path(), Receive(period, 3.0, correlation, &random));
    sum += std::pow((measured.value().log_scale - std::log(kMetres)) / measured->sigma, 2);
  }
  return sum / kRuns;
}

TEST(PositionScale, IsExactForExactPositions) {
  RandomGeometry random(1);
  std::vector<PositionFix> fixes = Receive(1.0, 0.0, 0.0, &random);
  for (PositionFix& fix : fixes) fix.sigma = 1.0;
  const auto measured = MeasureScaleByPositions(Path(), fixes);
  EXPECT_NEAR(measured.value().log_scale, std::log(kMetres), 1e-9);
}

TEST(PositionScale, ErrorsAreAsLargeAsItsSigma) {
  // Birge's ratio can only widen.
  const double independent = MeanSquaredError(10.0, 0.0);
  EXPECT_GT(independent, 0.6);
  EXPECT_LT(independent, 1.3);
  const double correlated = MeanSquaredError(1.0, 5.0);
  EXPECT_GT(correlated, 0.5);
  EXPECT_LT(correlated, 1.3);
}

TEST(PositionScale, AFewWrongFixesDoNotCount) {
  RandomGeometry random(3);
  std::vector<PositionFix> fixes = Receive(5.0, 0.5, 0.0, &random);
  for (size_t i = 3; i < fixes.size(); i += 13) fixes[i].position += Eigen::Vector3d(80, 0, 0);
  const auto measured = MeasureScaleByPositions(Path(), fixes);
  EXPECT_NEAR(measured.value().log_scale, std::log(kMetres), 4 * measured->sigma);
  EXPECT_LT(measured->sigma, 0.05);
}

TEST(PositionScale, IsEmptyWhereTheFixesTellNothing) {
  RandomGeometry random(4);
  const std::vector<PositionFix> fixes = Receive(10.0, 3.0, 0.0, &random);
  EXPECT_FALSE(MeasureScaleByPositions(Path(), std::span(fixes).first(2)));
  std::vector<PositionFix> later = fixes;
  for (PositionFix& fix : later) fix.timestamp += 1000;
  EXPECT_FALSE(MeasureScaleByPositions(Path(), later));
  std::vector<PositionFix> coarse = fixes;
  for (PositionFix& fix : coarse) fix.sigma = 2000;
  EXPECT_FALSE(MeasureScaleByPositions(Path(), coarse));
  std::vector<PositionFix> wrong = fixes;
  wrong[2].sigma = 0;
  EXPECT_THROW(MeasureScaleByPositions(Path(), wrong), ContractError);
  wrong[2] = {.timestamp = 20, .position = {NAN, 0, 0}, .sigma = 1};
  EXPECT_THROW(MeasureScaleByPositions(Path(), wrong), ContractError);
}

TEST(FuseScales, WeighsByPrecisionWhereBothAgree) {
  bool is_conflict = true;
  const ScaleMeasurement fused = FuseScales({0.10, 0.04}, {0.05, 0.02}, &is_conflict);
  EXPECT_FALSE(is_conflict);
  EXPECT_NEAR(fused.log_scale, 0.06, 1e-12);
  EXPECT_NEAR(fused.sigma, 0.04 / std::sqrt(5.0), 1e-12);
}

TEST(FuseScales, CoversBothWhereTheyContradictEachOther) {
  bool is_conflict = false;
  const ScaleMeasurement a{0.5, 0.02};
  const ScaleMeasurement b{0.0, 0.05};
  const ScaleMeasurement fused = FuseScales(a, b, &is_conflict);
  EXPECT_TRUE(is_conflict);
  EXPECT_GT(fused.log_scale, b.log_scale);
  EXPECT_LT(fused.log_scale, a.log_scale);
  // The mean square error about the result, whichever is right.
  EXPECT_NEAR(fused.sigma, std::hypot(a.sigma, fused.log_scale - a.log_scale), 1e-12);
  EXPECT_NEAR(fused.sigma, std::hypot(b.sigma, fused.log_scale - b.log_scale), 1e-12);
}

}  // namespace
}  // namespace orb360
