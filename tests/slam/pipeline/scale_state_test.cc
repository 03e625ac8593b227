#include "slam/pipeline/scale_state.h"

#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

using Grounds = std::vector<std::optional<KnownGround>>;

constexpr double kHeight = 1.5;
const KnownGround kGround{.up = Eigen::Vector3d::UnitZ(), .camera_height = kHeight};

// A walk whose poses are `factors` times as long as the steps over the ground say, by keyframe; 0:
// no step was measured. Landmarks lie within these ranges of the first camera.
Map WalkOver(const std::vector<double>& factors, double nearest = 3.0, double farthest = 12.0) {
  SyntheticScene scene(300, nearest, farthest);
  Map map = scene.MakeMap(Walk(static_cast<int>(factors.size()), {-1.0, 0.0, 0.0}), 300);
  for (size_t i = 1; i < factors.size(); ++i) {
    if (factors[i] == 0) continue;
    const auto id = static_cast<KeyframeId>(i);
    const double distance = (map.PoseOf(id).translation - map.PoseOf(id - 1).translation).norm();
    map.keyframe(id).ground_steps.push_back(
        {.keyframe = id - 1, .ratio = distance / factors[i] / kHeight, .sigma = 0.002});
  }
  return map;
}

EstimatedScale Estimate(const Map& map, const std::optional<KnownGround>& ground,
                        double camera_height = kHeight) {
  ScaleOptions options;
  options.camera_height = camera_height;
  const Grounds grounds = {ground};
  return EstimateScale(std::span(&map, 1), grounds, options);
}

TEST(ScaleState, IsMetricWhereStepsHoldAGivenHeight) {
  const EstimatedScale scale = Estimate(WalkOver(std::vector<double>(12, 1.0)), kGround);
  EXPECT_EQ(scale.whole.state, ScaleState::kMetric);
  EXPECT_NEAR(scale.whole.value, 1.0, 1e-3);
  // The height's own standard deviation is what all steps share.
  EXPECT_GE(scale.whole.sigma, ScaleOptions{}.camera_height_sigma);
  EXPECT_LT(scale.whole.sigma, 0.025);
  EXPECT_FALSE(scale.whole.is_height_assumed);
  EXPECT_EQ(scale.whole.sources.front(), "images of the ground");
  ASSERT_EQ(scale.keyframes.size(), 12u);
  for (const KeyframeScale& keyframe : scale.keyframes) {
    EXPECT_NEAR(keyframe.value, 1.0, 1e-3);
    EXPECT_GE(keyframe.sigma, ScaleOptions{}.camera_height_sigma);
  }
}

TEST(ScaleState, TakesTheDistanceBetweenTheLensesOutOrCoversIt) {
  Map map = WalkOver(std::vector<double>(16, 1.0));
  const double ratio = map.keyframe(1).ground_steps.front().ratio;
  const auto see = [&](const LensDistance& distance) {
    for (KeyframeId id = 1; id < 16; ++id) {
      GroundStepFrom& step = map.keyframe(id).ground_steps.front();
      step.per_lens_distance = 1;
      step.lens_distance = distance;
    }
    return Estimate(map, kGround).whole;
  };
  const MetricScale certain = see({0.02, 0.004});
  EXPECT_NEAR(certain.value, (ratio + 0.02) / ratio, 2e-3);
  EXPECT_NEAR(certain.lens_distance, 0.02 * kHeight, 1e-6);
  EXPECT_LT(certain.sigma, 0.025);
  const MetricScale uncertain = see({0.02, 0.04});
  EXPECT_NEAR(uncertain.value, 1.0, 1e-3);
  EXPECT_EQ(uncertain.lens_distance, 0);
  EXPECT_GT(std::hypot(0.02, 0.01 / ratio), 0.022);
  EXPECT_NEAR(uncertain.sigma, std::hypot(0.02, 0.01 / ratio), 0.004);
}

TEST(ScaleState, AnAssumedHeightIsNeverMetric) {
  const EstimatedScale scale = Estimate(WalkOver(std::vector<double>(12, 1.0)), kGround, 0.0);
  EXPECT_EQ(scale.whole.state, ScaleState::kRough);
  EXPECT_TRUE(scale.whole.is_height_assumed);
  EXPECT_GT(scale.whole.sigma, 0.2);
  EXPECT_GT(scale.whole.surroundings_rise, 1.0);
}

TEST(ScaleState, SaysByHowMuchThePathContradictsTheSteps) {
  const EstimatedScale scale = Estimate(WalkOver(std::vector<double>(12, 1.1)), kGround);
  EXPECT_NEAR(scale.whole.value, 1 / 1.1, 2e-3);
}

TEST(ScaleState, IsUnknownWhereNothingShowsTheGround) {
  const Map map = WalkOver(std::vector<double>(8, 0.0));
  const EstimatedScale without = Estimate(map, std::nullopt);
  EXPECT_EQ(without.whole.state, ScaleState::kUnknown);
  EXPECT_EQ(without.whole.value, 0);
  EXPECT_TRUE(without.whole.sources.empty());
  EXPECT_EQ(without.keyframes.front().value, 0);
  // Completed depth alone has been wrong by a factor.
  KnownGround completed = kGround;
  completed.is_rough = true;
  const EstimatedScale by_depth = Estimate(map, completed);
  EXPECT_EQ(by_depth.whole.state, ScaleState::kUnknown);
  EXPECT_GT(by_depth.whole.sigma, 0.3);
  EXPECT_EQ(by_depth.whole.sources, std::vector<std::string>{"completed depth"});
  // Steps that never agreed on a ground do not make it any better.
  const EstimatedScale beside = Estimate(WalkOver(std::vector<double>(8, 1.0)), completed);
  EXPECT_EQ(beside.whole.sources, by_depth.whole.sources);
  EXPECT_GT(beside.whole.sigma, 0.3);
  // A ground that no keyframe of the finished map shows tells nothing.
  EXPECT_EQ(Estimate(map, kGround).whole.value, 0);
  EXPECT_EQ(EstimateScale({}, {}, {}).whole.state, ScaleState::kUnknown);
}

TEST(ScaleState, TheLeastCertainMapTellsTheStateOfTheWhole) {
  std::vector<Map> maps;
  maps.push_back(WalkOver(std::vector<double>(12, 1.0)));
  maps.push_back(WalkOver(std::vector<double>(8, 0.0)));
  ScaleOptions options;
  options.camera_height = kHeight;
  EXPECT_EQ(EstimateScale(maps, Grounds{kGround, std::nullopt}, options).whole.state,
            ScaleState::kUnknown);
}

TEST(ScaleState, IsUnknownWhereTheHeightVaries) {
  // A drone takes off: the steps seem to be twelve times as short once it is up.
  std::vector<double> factors(16, 1.0);
  for (int i = 8; i < 16; ++i) factors[i] = 12;
  const EstimatedScale scale = Estimate(WalkOver(factors), kGround);
  EXPECT_EQ(scale.whole.state, ScaleState::kUnknown);
  // The truth, 1, is within the stated errors everywhere.
  EXPECT_LT(std::abs(std::log(scale.whole.value)), 2 * scale.whole.sigma);
  for (const KeyframeScale& keyframe : scale.keyframes) {
    EXPECT_LT(std::abs(std::log(keyframe.value)), 3 * keyframe.sigma);
  }
}

TEST(ScaleState, TheStandardDeviationGrowsAwayFromTheLastStep) {
  std::vector<double> factors(14, 0.0);
  for (int i = 1; i < 6; ++i) factors[i] = 1.0;
  const EstimatedScale scale = Estimate(WalkOver(factors), kGround);
  EXPECT_GT(scale.keyframes[13].sigma, scale.keyframes[8].sigma);
  EXPECT_GT(scale.keyframes[8].sigma, scale.keyframes[4].sigma);
}

TEST(ScaleState, NearLandmarksPassTheScaleOnBetterThanFarOnes) {
  std::vector<double> factors(12, 0.0);
  for (int i = 1; i < 5; ++i) factors[i] = 1.0;
  const auto sigma_at_end = [&](double nearest, double farthest) {
    return Estimate(WalkOver(factors, nearest, farthest), kGround).keyframes.back().sigma;
  };
  EXPECT_GT(sigma_at_end(100.0, 200.0), 3 * sigma_at_end(3.0, 12.0));
}

// What a receiver says of a walk whose unit of length is `metres`, with errors of the standard
// deviation that it states: the residuals count as much as what is stated.
Positions FixesOf(const Map& map, double metres, double sigma) {
  std::vector<PositionFix> fixes;
  for (const KeyframeId id : map.KeyframeIds()) {
    const Keyframe& keyframe = map.keyframe(id);
    const Eigen::Vector3d phase(37.0 * id, 59.0 * id + 1, 83.0 * id + 2);
    const Eigen::Vector3d error = sigma * std::numbers::sqrt2 * phase.array().sin();
    fixes.push_back(
        {keyframe.timestamp + 1e-3,
         metres * keyframe.world_from_camera.translation + Eigen::Vector3d(7, 8, 9) + error, sigma,
         sigma});
  }
  return {fixes};
}

EstimatedScale EstimateBy(const Map& map, const std::optional<KnownGround>& ground, double metres,
                          double sigma, bool is_height_given = true) {
  ScaleOptions options;
  options.camera_height = ground && is_height_given ? kHeight : 0.0;
  const Grounds grounds = {ground};
  return EstimateScale(std::span(&map, 1), grounds, options, FixesOf(map, metres, sigma));
}

TEST(ScaleState, PositionsMakeItMetricWithoutGround) {
  const Map map = WalkOver(std::vector<double>(12, 0.0));
  const EstimatedScale scale = EstimateBy(map, std::nullopt, 3.0, 0.01);
  EXPECT_EQ(scale.whole.state, ScaleState::kMetric);
  EXPECT_NEAR(scale.whole.value, 3.0, 0.01);
  EXPECT_EQ(scale.whole.sources, std::vector<std::string>{"positions"});
  EXPECT_EQ(scale.whole.camera_height, 0.0);
  EXPECT_NEAR(scale.keyframes.back().value, 3.0, 0.01);
  EXPECT_EQ(scale.keyframes.back().sigma, scale.whole.sigma);
  EXPECT_EQ(EstimateBy(map, std::nullopt, 3.0, 1.0).whole.state, ScaleState::kRough);
}

TEST(ScaleState, PositionsTellTheScaleOfAPathWhoseHeightVaries) {
  std::vector<double> factors(16, 1.0);
  for (int i = 8; i < 16; ++i) factors[i] = 12;
  for (const bool is_height_given : {true, false}) {
    const EstimatedScale scale = EstimateBy(WalkOver(factors), kGround, 1.0, 0.01, is_height_given);
    EXPECT_EQ(scale.whole.state, ScaleState::kMetric);
    EXPECT_NEAR(scale.whole.value, 1.0, 0.01);
    EXPECT_EQ(scale.whole.sources, std::vector<std::string>{"positions"});
    // Where the path is bent, nobody knows.
    for (const KeyframeScale& keyframe : scale.keyframes) EXPECT_GT(keyframe.sigma, 0.3);
  }
}

TEST(ScaleState, PositionsAndGroundThatAgreeAreSurerThanEach) {
  const Map map = WalkOver(std::vector<double>(12, 1.0));
  const double by_ground = Estimate(map, kGround).whole.sigma;
  const MetricScale by_positions = EstimateBy(map, std::nullopt, 1.03, 0.1).whole;
  const EstimatedScale both = EstimateBy(map, kGround, 1.03, 0.1);
  EXPECT_EQ(both.whole.state, ScaleState::kMetric);
  EXPECT_LT(both.whole.sigma, by_ground);
  EXPECT_LT(both.whole.sigma, by_positions.sigma);
  EXPECT_GT(both.whole.value, 1.0);
  EXPECT_LT(both.whole.value, by_positions.value);
}

TEST(ScaleState, IsRoughWherePositionsContradictTheGround) {
  const Map map = WalkOver(std::vector<double>(12, 1.0));
  const EstimatedScale scale = EstimateBy(map, kGround, 1.2, 0.01);
  EXPECT_EQ(scale.whole.state, ScaleState::kRough);
  EXPECT_GT(scale.whole.value, 1.0);
  EXPECT_LT(scale.whole.value, 1.2);
  EXPECT_GT(scale.whole.sigma, 0.05);
}

TEST(ScaleState, PositionsRefuteAnAssumedHeight) {
  const Map map = WalkOver(std::vector<double>(12, 1.0));
  const EstimatedScale scale = EstimateBy(map, kGround, 40, 0.01, /*is_height_given=*/false);
  EXPECT_EQ(scale.whole.state, ScaleState::kMetric);
  EXPECT_NEAR(scale.whole.value, 40, 0.1);
  EXPECT_EQ(scale.whole.sources, std::vector<std::string>{"positions"});
  EXPECT_EQ(scale.whole.camera_height, 0.0);
  EXPECT_EQ(EstimateBy(map, kGround, 40, 0.01).whole.state, ScaleState::kUnknown) << "it was given";
}

}  // namespace
}  // namespace orb360
