#include "slam/scale/ground_sweep.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "slam/features/sphere_pyramid.h"
#include "tests/slam/scale/ground_scene.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

constexpr double kHeight = 1.0;
const Rigid3 kFirst{ExpSo3({0.03, -0.02, 0.4}), {0.0, 0.0, kHeight}};

// The camera after a step along the ground, turned a little.
Rigid3 After(double step) {
  return {ExpSo3({-0.02, 0.03, 0.45}), {0.8 * step, -0.6 * step, kHeight}};
}

std::optional<GroundStep> Measure(const Ground& ground, double step,
                                  const Eigen::Vector3d& up_error = Eigen::Vector3d::Zero(),
                                  const cv::Mat& mask = {}) {
  const Rigid3 second = After(step);
  Rigid3 motion = kFirst.Inverse() * second;
  motion.translation *= 7.0;  // its length must not matter
  const Eigen::Vector3d up =
      kFirst.rotation.conjugate() * (ExpSo3(up_error) * Eigen::Vector3d::UnitZ());
  return MeasureGroundStep(LookAtGround(kFirst, ground), LookAtGround(second, ground), motion, up,
                           mask, {});
}

TEST(MeasureGroundStep, FindsTheRatioOfStepAndHeightOnFlatGround) {
  const Asphalt asphalt(1);
  for (const double step : {0.17, 0.42, 0.96, 1.31, 2.2}) {
    const auto found = Measure(asphalt, step);
    ASSERT_TRUE(found) << step;
    EXPECT_NEAR(std::log(found->ratio / step), 0.0, 0.004) << step;
    EXPECT_GT(found->correlation, 0.5) << step;
    EXPECT_GE(found->num_tiles, 60) << step;
  }
}

TEST(MeasureGroundStep, AboveADamTheHeightIsThatOverItsTop) {
  const Asphalt top(11);
  const Asphalt plain(12);
  // The dam lies along the motion; the plain is twice as far below the camera.
  const Eigen::Vector2d across(0.6, 0.8);
  for (const double half_width : {0.6, 0.8}) {  // heights over the dam
    const auto shade = [&](const Eigen::Vector3d& lens, const Eigen::Vector3d& ray) {
      const Eigen::Vector2d above = (lens - lens.z() / ray.z() * ray).head<2>();
      if (std::abs(across.dot(above)) < half_width) return top(above);
      const Eigen::Vector2d below = (lens - (lens.z() + kHeight) / ray.z() * ray).head<2>();
      return std::abs(across.dot(below)) < half_width ? 90.0 : plain(below);  // 90: its walls
    };
    for (const double step : {0.3, 0.8}) {
      const Rigid3 second = After(step);
      const auto found = MeasureGroundStep(
          LookDownAt(shade, kFirst), LookDownAt(shade, second), kFirst.Inverse() * second,
          kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ(), {}, {});
      ASSERT_TRUE(found) << half_width << ' ' << step;
      EXPECT_NEAR(std::log(found->ratio / step), 0.0, 0.02) << half_width << ' ' << step;
    }
  }
}

// Boards along the motion, all alike, `period` heights long; what lies beside them does not repeat.
Ground Boards(double period, double half_width) {
  return [=, board = Asphalt(13), beside = Asphalt(14)](const Eigen::Vector2d& place) {
    const Eigen::Vector2d turned(0.8 * place.x() - 0.6 * place.y(),
                                 0.6 * place.x() + 0.8 * place.y());
    if (std::abs(turned.y()) > half_width) return beside(place);
    const double along = turned.x() - period * std::floor(turned.x() / period);
    return board(2.5 * Eigen::Vector2d(along, turned.y()));
  };
}

TEST(MeasureGroundStep, BoardsBelowDoNotLieHigherWhereTheyRepeat) {
  // The period and the step together are a whole number of coarse cells, the step alone is not.
  const auto found = Measure(Boards(1.1, 0.6), 0.14);
  ASSERT_TRUE(found);
  EXPECT_NEAR(std::log(found->ratio / 0.14), 0.0, 0.05);
}

TEST(MeasureGroundStep, StandingStillOnBoardsIsNoStepOfTheirLength) {
  EXPECT_FALSE(Measure(Boards(2.3, 5.0), 0.004));  // one period is in reach
}

// Square plates, all alike, whose edges lie along the motion and across it.
Ground Plates(double period) {
  return [=, plate = Asphalt(15)](const Eigen::Vector2d& place) {
    const Eigen::Vector2d turned(0.8 * place.x() - 0.6 * place.y(),
                                 0.6 * place.x() + 0.8 * place.y());
    const Eigen::Vector2d within = turned - period * (turned / period).array().floor().matrix();
    return plate(2.5 * within);
  };
}

TEST(MeasureGroundStep, WhereTheGroundRepeatsNoOtherGuessGivesAStep) {
  const double step = 0.8;
  const Rigid3 second = After(step);
  const Rigid3 motion = kFirst.Inverse() * second;
  const Eigen::Vector3d up = kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const SpherePyramid image1 = LookAtGround(kFirst, Plates(0.48));
  const SpherePyramid image2 = LookAtGround(second, Plates(0.48));
  const GroundSweepOptions options{.max_ratio = 0.9};
  // Steps of 0.32 and 0.8 look alike. About 70 degrees aside only that of 0.32 ahead and 0.48 aside
  // is in reach.
  const GroundStepGuess right{motion.translation, up};
  const GroundStepGuess aside{ExpSo3(1.22 * up) * motion.translation, up};
  const auto measure = [&](const std::vector<GroundStepGuess>& guesses) {
    return MeasureGroundStep(image1, image2, motion.rotation, guesses, {}, options);
  };
  const auto wrong = measure({aside});
  ASSERT_TRUE(wrong);
  EXPECT_NEAR(wrong->ratio, std::hypot(0.48, 0.32), 0.02);
  EXPECT_FALSE(measure({right}));
  EXPECT_FALSE(measure({right, aside}));
}

TEST(MeasureGroundStep, ALaterGuessCountsWhereTheFirstShowsNothing) {
  const Asphalt asphalt(16);
  const Rigid3 second = After(0.9);
  const Rigid3 motion = kFirst.Inverse() * second;
  const Eigen::Vector3d up = kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const std::vector<GroundStepGuess> guesses = {{ExpSo3(2.0 * up) * motion.translation, up},
                                                {motion.translation, up}};
  const auto found = MeasureGroundStep(LookAtGround(kFirst, asphalt), LookAtGround(second, asphalt),
                                       motion.rotation, guesses, {}, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(std::log(found->ratio / 0.9), 0.0, 0.006);
}

TEST(MeasureGroundStep, AnErrorOfTheNormalCancels) {
  const Asphalt asphalt(2);
  for (const Eigen::Vector3d& error : {Eigen::Vector3d(0.05, 0, 0), Eigen::Vector3d(0, -0.05, 0),
                                       Eigen::Vector3d(0.04, 0.04, 0)}) {
    const auto found = Measure(asphalt, 0.9, error);
    ASSERT_TRUE(found) << error.transpose();
    EXPECT_NEAR(std::log(found->ratio / 0.9), 0.0, 0.006) << error.transpose();
  }
}

TEST(MeasureGroundStep, FindsTheDirectionOfTheMotionToo) {
  const Asphalt asphalt(8);
  const double step = 0.9;
  const Rigid3 second = After(step);
  const Rigid3 motion = kFirst.Inverse() * second;
  for (const double error : {0.1, -0.15}) {  // rad, about the vertical
    Rigid3 wrong = motion;
    wrong.translation = ExpSo3({0, 0, error}) * motion.translation;
    const auto found =
        MeasureGroundStep(LookAtGround(kFirst, asphalt), LookAtGround(second, asphalt), wrong,
                          kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ(), {}, {});
    ASSERT_TRUE(found) << error;
    EXPECT_NEAR(std::log(found->ratio / step), 0.0, 0.006) << error;
    EXPECT_LT(std::acos(found->direction.dot(motion.translation.normalized())), 0.015) << error;
  }
}

TEST(MeasureGroundStep, FindsTheRotationAboutTheVerticalToo) {
  const Asphalt asphalt(9);
  const double step = 0.9;
  const Rigid3 second = After(step);
  const Rigid3 motion = kFirst.Inverse() * second;
  const Eigen::Vector3d up = kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  for (const double error : {0.0, 0.012, -0.02}) {  // rad
    Rigid3 wrong = motion;
    wrong.rotation = ExpSo3(error * up) * motion.rotation;
    const auto found = MeasureGroundStep(LookAtGround(kFirst, asphalt),
                                         LookAtGround(second, asphalt), wrong, up, {}, {});
    ASSERT_TRUE(found) << error;
    EXPECT_NEAR(found->turn, -error, 0.001) << error;
    EXPECT_LT(std::abs(found->turn + error), 4 * found->turn_sigma) << error;
    EXPECT_LT(found->turn_sigma, 0.0015) << error;
  }
}

TEST(MeasureGroundStep, TellsTheDistanceBetweenTheLensesAndTakesItOut) {
  const Asphalt asphalt(12);
  const double step = 0.8;
  const Rigid3 second{
      kFirst.rotation,
      kFirst.translation + step * (kFirst.rotation * Eigen::Vector3d(0.98, 0.2, 0).normalized())
                                      .cwiseProduct(Eigen::Vector3d(1, 1, 0))};
  const double true_step = (second.translation - kFirst.translation).norm();
  for (const double distance : {0.0, 0.02, -0.015}) {  // heights
    const auto measure = [&](double assumed) {
      return MeasureGroundStep(
          LookAtGround(kFirst, asphalt, 1.0, distance),
          LookAtGround(second, asphalt, 1.0, distance), kFirst.Inverse() * second,
          kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ(), {}, {.lens_distance = assumed});
    };
    const auto found = measure(0);
    ASSERT_TRUE(found) << distance;
    EXPECT_NEAR(found->ratio, true_step - distance, 0.005) << distance;
    EXPECT_GT(found->lens_distance.sigma, 0) << distance;
    EXPECT_LT(found->lens_distance.sigma, 0.01) << distance;
    EXPECT_NEAR(found->lens_distance.value, distance, 3 * found->lens_distance.sigma) << distance;
    EXPECT_NEAR(found->ratio + found->per_lens_distance * distance, true_step, 0.004) << distance;
    const auto corrected = measure(distance);
    ASSERT_TRUE(corrected) << distance;
    EXPECT_NEAR(std::log(corrected->ratio / true_step), 0.0, 0.004) << distance;
    EXPECT_NEAR(corrected->turn, 0.0, 0.001) << distance;
  }
}

TEST(MeasureGroundStep, ItsErrorsAreWithinItsSigma) {
  double squares = 0;
  constexpr int kCount = 12;
  for (unsigned seed = 10; seed < 10 + kCount; ++seed) {
    const double step = 0.3 + 0.11 * (seed - 10);
    const auto found = Measure(Asphalt(seed), step);
    ASSERT_TRUE(found) << step;
    const double error = std::log(found->ratio / step) / found->sigma;
    EXPECT_LT(std::abs(error), 4.0) << step;
    squares += error * error;
  }
  EXPECT_LT(squares / kCount, 2.5);
}

TEST(MeasureGroundStep, IsEmptyWhereTheGroundHasNoTexture) {
  EXPECT_FALSE(Measure([](const Eigen::Vector2d&) { return 100.0; }, 0.8));
}

TEST(MeasureGroundStep, IsEmptyWhereTheGroundRepeatsItself) {
  const auto slabs = [](const Eigen::Vector2d& p) {
    return 110 + 40 * std::sin(2 * std::numbers::pi * (0.8 * p.x() - 0.6 * p.y()) / 0.4) +
           30 * std::sin(2 * std::numbers::pi * (0.6 * p.x() + 0.8 * p.y()) / 0.4);
  };
  EXPECT_FALSE(Measure(slabs, 0.9));
}

TEST(MeasureGroundStep, IsEmptyForDifferentGrounds) {
  const Rigid3 second = After(0.8);
  EXPECT_FALSE(MeasureGroundStep(LookAtGround(kFirst, Asphalt(3)), LookAtGround(second, Asphalt(4)),
                                 kFirst.Inverse() * second,
                                 kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ(), {}, {}));
}

TEST(MeasureGroundStep, IsEmptyWhereTheCameraRises) {
  const Asphalt asphalt(5);
  const Rigid3 second{kFirst.rotation, kFirst.translation + Eigen::Vector3d(0, 0, 0.5)};
  EXPECT_FALSE(MeasureGroundStep(LookAtGround(kFirst, asphalt), LookAtGround(second, asphalt),
                                 kFirst.Inverse() * second,
                                 kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ(), {}, {}));
}

TEST(MeasureGroundStep, WhatTheMaskCoversDoesNotCount) {
  // A carrier covers all below 45 degrees under the horizon and moves with the camera. Its stripes
  // look alike at multiples of their distance, which the step is not.
  const Asphalt asphalt(6);
  const double step = 0.5;
  const Rigid3 second = After(step);
  const Eigen::Vector2d along = (kFirst.rotation.conjugate() * second.translation -
                                 kFirst.rotation.conjugate() * kFirst.translation)
                                    .head<2>()
                                    .normalized();
  const auto paint = [&](const Eigen::Vector2d& p) {
    return 110 + 60 * std::sin(2 * std::numbers::pi * along.dot(p) / 0.3);
  };
  const EquirectangularCamera camera(kGroundWidth, kGroundWidth / 2);
  cv::Mat mask(kGroundWidth / 2, kGroundWidth, CV_8U, cv::Scalar(255));
  mask.rowRange(3 * kGroundWidth / 8, kGroundWidth / 2).setTo(0);
  const auto look = [&](const Rigid3& pose) {
    SpherePyramid bare = LookAtGround(pose, asphalt);
    cv::Mat gray = bare.front().image().clone();
    for (int v = 3 * kGroundWidth / 8; v < kGroundWidth / 2; ++v) {
      for (int u = 0; u < kGroundWidth; ++u) {
        const Eigen::Vector3d ray = camera.Bearing({u + 0.5, v + 0.5});
        gray.at<uint8_t>(v, u) = cv::saturate_cast<uint8_t>(paint((ray / -ray.z()).head<2>()));
      }
    }
    SpherePyramid pyramid;
    BuildSpherePyramid(gray, 8, &pyramid);
    return pyramid;
  };
  const auto measure = [&](const cv::Mat& used) {
    return MeasureGroundStep(look(kFirst), look(second), kFirst.Inverse() * second,
                             kFirst.rotation.conjugate() * Eigen::Vector3d::UnitZ(), used, {});
  };
  const auto found = measure(mask);
  ASSERT_TRUE(found);
  EXPECT_NEAR(std::log(found->ratio / step), 0.0, 0.02);
  const auto without = measure({});
  EXPECT_TRUE(!without || std::abs(std::log(without->ratio / step)) > 0.1) << without->ratio;
}

}  // namespace
}  // namespace orb360
