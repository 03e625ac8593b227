#include "slam/evaluation/local_scale.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

using Trajectory = std::vector<StampedPose>;

constexpr double kFrameTime = 0.1;  // seconds

/// Poses at `x_of(i)` metres along a straight line.
Trajectory Line(int count, const std::function<double(int)>& x_of) {
  Trajectory poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({kFrameTime * i, {Eigen::Quaterniond::Identity(), {x_of(i), 0, 0}}});
  }
  return poses;
}

Trajectory Line(int count, double step) {
  return Line(count, [=](int i) { return step * i; });
}

/// A bend with radius of 15 m to the left, then one to the right, and so on, 0.5 m a frame.
Trajectory Serpentine(int count) {
  constexpr double kRadius = 15.0;
  Trajectory poses;
  Eigen::Vector3d position(0, 0, 0);
  double heading = 0.0;
  for (int i = 0; i < count; ++i) {
    poses.push_back({kFrameTime * i, {ExpSo3({0, 0, heading}), position}});
    position += 0.5 * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0);
    heading += (i / 150 % 2 == 0 ? 0.5 : -0.5) / kRadius;
  }
  return poses;
}

Trajectory Moved(Trajectory poses, const Similarity3& moved_from_world) {
  for (StampedPose& pose : poses) {
    pose.world_from_camera = TransformPose(moved_from_world, pose.world_from_camera);
  }
  return poses;
}

/// Independent noise of `sigma` metres in each direction.
Trajectory Noisy(Trajectory poses, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  for (StampedPose& pose : poses) {
    pose.world_from_camera.translation +=
        Eigen::Vector3d(noise(random), noise(random), noise(random));
  }
  return poses;
}

std::optional<LocalScale> Measure(const Trajectory& truth, const Trajectory& estimate,
                                  const std::vector<double>& map_changes = {}) {
  return MeasureLocalScale(truth, PairPoses(truth, estimate, 0.01), map_changes);
}

double PathLength(const Trajectory& poses) {
  double length = 0.0;
  for (size_t i = 1; i < poses.size(); ++i) {
    length += (poses[i].world_from_camera.translation - poses[i - 1].world_from_camera.translation)
                  .norm();
  }
  return length;
}

TEST(LocalScale, AConstantFactorIsThatFactorInEveryWindowAndNoDrift) {
  const Similarity3 smaller{0.8, ExpSo3({0.3, -1.2, 2.0}), {40, -7, 12}};
  const Trajectory truth = Serpentine(801);
  const auto scale = Measure(truth, Moved(truth, smaller));
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->min, 1.25, 1e-9);
  EXPECT_NEAR(scale->max, 1.25, 1e-9);
  EXPECT_NEAR(scale->drift_median.value(), 0.0, 1e-9);
  EXPECT_NEAR(scale->drift_worst.value(), 0.0, 1e-9);
  EXPECT_NEAR(scale->worst_deviation.value(), 0.25, 1e-9);
}

TEST(LocalScale, WindowsSlideByFiveMetresFromTheStartToTheEnd) {
  const auto scale = Measure(Line(401, 0.5), Line(401, 0.5));  // 200 m
  ASSERT_TRUE(scale);
  ASSERT_EQ(scale->windows.size(), 37u);  // They begin at 0, 5, ... 180 m.
  for (size_t i = 0; i < scale->windows.size(); ++i) {
    EXPECT_EQ(scale->windows[i].begin, 5.0 * static_cast<double>(i));
  }
}

TEST(LocalScale, AnExponentialDriftIsItsRate) {
  // The estimate loses 4 % of its unit in 100 m: x metres of path are (1 - exp(-r x)) / r long, and
  // ln(true / estimated) of a window that begins at s is ln(20 r / (1 - exp(-20 r))) + r s.
  constexpr double kRate = 0.0004;
  const Trajectory estimate =
      Line(1001, [](int i) { return (1.0 - std::exp(-kRate * i)) / kRate; });
  const auto scale = Measure(Line(1001, 1.0), estimate);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->drift_median.value(), 100.0 * kRate, 1e-9);
  EXPECT_NEAR(scale->drift_worst.value(), 100.0 * kRate, 1e-9);
  const double first = 20.0 * kRate / (1.0 - std::exp(-20.0 * kRate));
  EXPECT_NEAR(scale->min, first, 1e-9);
  EXPECT_NEAR(scale->max, first * std::exp(980.0 * kRate), 1e-9);
  for (const auto& [begin, ratio, begin_time, end_time] : scale->windows) {
    EXPECT_NEAR(std::log(ratio / first), kRate * begin, 1e-6);  // of interpolation
  }
  // The scale of 100 m is worst in the last ones.
  EXPECT_NEAR(scale->worst_deviation.value(),
              100.0 * kRate / (1.0 - std::exp(-100.0 * kRate)) * std::exp(900.0 * kRate) - 1.0,
              1e-9);
}

TEST(LocalScale, AJumpIsFoundAtItsPlaceAndOnlyThere) {
  // From 400 m on a metre is two thirds as long in the estimate.
  const Trajectory estimate =
      Line(1001, [](int i) { return i <= 400 ? i : 400.0 + (i - 400) / 1.5; });
  const auto scale = Measure(Line(1001, 1.0), estimate);
  ASSERT_TRUE(scale);
  for (const auto& [begin, ratio, begin_time, end_time] : scale->windows) {
    if (begin <= 380.0) {
      EXPECT_NEAR(ratio, 1.0, 1e-9) << begin;
    } else if (begin >= 400.0) {
      EXPECT_NEAR(ratio, 1.5, 1e-9) << begin;
    } else {  // 20 over the sum of what lies before and behind.
      EXPECT_NEAR(ratio, 20.0 / ((400.0 - begin) + (begin - 380.0) / 1.5), 1e-9) << begin;
    }
  }
  EXPECT_NEAR(scale->drift_median.value(), 0.0, 1e-9);
  EXPECT_NEAR(scale->drift_worst.value(), std::log(1.5), 1e-9);
}

TEST(LocalScale, NoiseOfEachFrameDoesNotLengthenThePath) {
  // A walk in steps of 0.1 m with noise of 4 mm. It lengthens a step by 2 (4 mm)^2 / 0.1 m, 0.3 %
  // of it, but a chord of 2 m by 0.001 %. The ends of a window have an error of sqrt(2) 4 mm, of
  // 20 m 0.03 %.
  const Trajectory truth = Line(6001, 0.1);
  const Trajectory estimate = Noisy(truth, 0.004, 1);
  EXPECT_GT(PathLength(estimate) / PathLength(truth), 1.0025) << "the noise does what it should";
  const auto scale = Measure(truth, estimate);
  ASSERT_TRUE(scale);
  double mean = 0.0;
  for (const auto& [begin, ratio, begin_time, end_time] : scale->windows) {
    mean += ratio / static_cast<double>(scale->windows.size());
  }
  EXPECT_NEAR(mean, 1.0, 1e-4);
  EXPECT_GT(scale->min, 0.9985);
  EXPECT_LT(scale->max, 1.0015);
  EXPECT_LT(scale->drift_median.value(), 0.0005);
  EXPECT_LT(scale->drift_worst.value(), 0.0020);
}

TEST(LocalScale, NoiseOfTheTruthDoesNotEither) {
  // A position track of 2 cm at steps of 0.1 m: a step is about 8 % too long, a chord of 2 m by
  // 0.02 %.
  const Trajectory path = Line(6001, 0.1);
  const Trajectory truth = Noisy(path, 0.02, 2);
  EXPECT_GT(PathLength(truth) / PathLength(path), 1.05);
  const auto scale = Measure(truth, path);
  ASSERT_TRUE(scale);
  double mean = 0.0;
  for (const auto& [begin, ratio, begin_time, end_time] : scale->windows) {
    mean += ratio / static_cast<double>(scale->windows.size());
  }
  EXPECT_NEAR(mean, 1.0, 0.002);
  EXPECT_LT(scale->drift_median.value(), 0.003);
}

TEST(LocalScale, ACameraThatStandsAddsNothing) {
  // It stands for 100 s on a path of 60 m.
  const auto x = [](int i) { return 0.1 * (i < 300 ? i : std::max(300, i - 1000)); };
  const Trajectory truth = Line(1601, x);
  const auto scale = Measure(truth, Noisy(truth, 0.004, 3));
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->windows.size(), 9u);
  EXPECT_GT(scale->min, 0.998);
  EXPECT_LT(scale->max, 1.002);
}

/// A path of 500 m in steps of 0.5 m whose estimate leaves out the frames from `first` to before
/// `end` and continues displaced, because the motion between was assumed.
Trajectory WithGap(int first, int end) {
  Trajectory estimate = Line(1001, 0.5);
  for (size_t i = static_cast<size_t>(end); i < estimate.size(); ++i) {
    estimate[i].world_from_camera.translation += Eigen::Vector3d(30, -4, 0);
  }
  estimate.erase(estimate.begin() + first, estimate.begin() + end);
  return estimate;
}

TEST(LocalScale, WindowsAcrossLostFramesAreLeftOut) {
  for (const int lost : {1, 2, 17}) {
    const auto scale = Measure(Line(1001, 0.5), WithGap(400, 400 + lost));
    ASSERT_TRUE(scale);
    EXPECT_NEAR(scale->min, 1.0, 1e-9) << lost;
    EXPECT_NEAR(scale->max, 1.0, 1e-9) << lost;
    // From the last frame before to the first one after.
    const double gap_begin = 0.5 * 399;
    const double gap_end = 0.5 * (400 + lost);
    size_t whole = 0;
    for (double begin = 0.0; begin <= 480.0; begin += LocalScale::kStep) {
      const bool is_whole = begin + LocalScale::kWindow <= gap_begin || begin >= gap_end;
      EXPECT_EQ(std::ranges::count(scale->windows, begin, &LocalScale::Window::begin), is_whole)
          << begin;
      whole += is_whole;
    }
    EXPECT_EQ(scale->windows.size(), whole);
    EXPECT_NEAR(scale->worst_deviation.value(), 0.0, 1e-9);
  }
}

TEST(LocalScale, WindowsAcrossMapsAreLeftOut) {
  const Trajectory truth = Line(1001, 0.5);
  const Trajectory estimate = WithGap(400, 400);  // No frame is lost, but the path jumps by 30 m.
  EXPECT_LT(Measure(truth, estimate)->min, 0.5);
  const auto scale = Measure(truth, estimate, {truth[400].timestamp});
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->min, 1.0, 1e-9);
  EXPECT_NEAR(scale->max, 1.0, 1e-9);
  EXPECT_EQ(scale->windows.size(), 97u - 4u);  // Without those from 180 to 195 m.
}

TEST(LocalScale, AChangeOfScaleAtALossIsDrift) {
  Trajectory estimate = WithGap(500, 510);
  for (size_t i = 500; i < estimate.size(); ++i) {
    estimate[i].world_from_camera.translation *= 0.5;
  }
  const auto scale = Measure(Line(1001, 0.5), estimate);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->min, 1.0, 1e-9);
  EXPECT_NEAR(scale->max, 2.0, 1e-9);
  EXPECT_NEAR(scale->drift_worst.value(), std::log(2.0), 1e-9);
}

TEST(LocalScale, ATruthOfAHigherRateHasNoGaps) {
  const Trajectory truth = Line(10001, 0.02);  // 200 m; one in 7 of the poses is estimated
  Trajectory estimate;
  for (size_t i = 0; i < truth.size(); i += 7) estimate.push_back(truth[i]);
  const auto pairs = PairPoses(truth, estimate, 0.001);
  const auto scale = MeasureLocalScale(truth, pairs);
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->windows.size(), 36u);  // The last pose is at 199.92 m.
  estimate.erase(estimate.begin() + 700);
  const auto with_gap = MeasureLocalScale(truth, PairPoses(truth, estimate, 0.001));
  ASSERT_TRUE(with_gap);
  EXPECT_LT(with_gap->windows.size(), 36u);
}

TEST(LocalScale, ThePathBeforeTheFirstPairCounts) {
  const Trajectory truth = Line(201, 1.0);
  const auto scale = Measure(truth, Trajectory(truth.begin() + 12, truth.end()));
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->windows.front().begin, 15.0);
  EXPECT_EQ(scale->windows.back().begin, 180.0);
}

TEST(LocalScale, PathsThatAreTooShortHaveNone) {
  const auto of_length = [](int metres) {
    return Measure(Line(metres + 1, 1.0), Line(metres + 1, 1.0));
  };
  EXPECT_FALSE(MeasureLocalScale({}, {}));
  EXPECT_FALSE(of_length(0));
  EXPECT_FALSE(of_length(19));
  EXPECT_TRUE(of_length(20));
  EXPECT_FALSE(of_length(119)->drift_median);
  EXPECT_FALSE(of_length(119)->drift_worst);
  EXPECT_TRUE(of_length(120)->drift_median);
  EXPECT_FALSE(of_length(99)->worst_deviation);
  EXPECT_TRUE(of_length(100)->worst_deviation);
  // Long, but in parts of 19 m, between which three frames are lost.
  Trajectory estimate = Line(500, 1.0);
  std::erase_if(estimate, [](const StampedPose& pose) {
    return std::lround(pose.timestamp / kFrameTime) % 23 > 19;
  });
  EXPECT_FALSE(Measure(Line(500, 1.0), estimate));
  // A camera that stands is nowhere, however much noise there is.
  EXPECT_FALSE(Measure(Line(500, 0.0), Line(500, 1.0)));
}

TEST(LocalScale, AnEstimateThatStandsStillHasAFiniteRatio) {
  const auto scale = Measure(Line(501, 1.0), Line(501, [](int i) { return std::min(i, 200); }));
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->max, 1e6, 1e-3);
  EXPECT_NEAR(scale->drift_worst.value(), std::log(1e6), 1e-9);
}

}  // namespace
}  // namespace orb360
