#include "slam/features/patch_alignment.h"

#include <cmath>
#include <functional>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

using Gray = std::function<double(const Eigen::Vector2d&)>;  // of a continuous pixel

constexpr int kWidth = 256;
constexpr int kHeight = 128;
const Eigen::Vector2d kCenter(101.3, 60.8);
const Eigen::Matrix2d kSteps = 0.5 * Eigen::Matrix2d::Identity();

// A level that is one pixel at each place, the margin of the sphere included.
PyramidLevel Draw(const Gray& gray) {
  PyramidLevel level{
      EquirectangularCamera(kWidth, kHeight), 1.0,
      cv::Mat(kHeight + 2 * PyramidLevel::kMarginY, kWidth + 2 * PyramidLevel::kMarginX, CV_8U)};
  cv::Mat image = level.image();
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      image.at<uint8_t>(v, u) = cv::saturate_cast<uint8_t>(gray({u + 0.5, v + 0.5}));
    }
  }
  FillSphereMargin(&level);
  return level;
}

// Smooth, without a period that would make another place look the same.
double Clouds(const Eigen::Vector2d& p) {
  return 120 + 40 * std::sin(0.9 * p.x() + 0.3 * p.y()) + 30 * std::cos(0.5 * p.x() - 0.8 * p.y()) +
         20 * std::sin(1.3 * p.y() + 0.2 * p.x());
}

Patch PatchAt(const PyramidLevel& level, const Eigen::Vector2d& center) {
  return SamplePatch(level, {center, kSteps}).value();
}

// Without a surface that could have a slope: as from one place.
std::optional<Eigen::Vector2d> AlignFlat(const Patch& patch, const PyramidLevel& level,
                                         const PatchGrid& guess) {
  PatchSlope slope;
  slope.information.setIdentity();
  const auto aligned = AlignPatch(patch, level, guess, Eigen::Vector2d::Zero(), slope);
  if (!aligned) return std::nullopt;
  EXPECT_EQ(aligned->slope.mean, slope.mean);
  EXPECT_EQ(aligned->slope.information, slope.information);
  return aligned->center;
}

TEST(SamplePatch, BlendsTheFourPixelsAroundEachSample) {
  const PyramidLevel level = Draw([](const Eigen::Vector2d& p) { return p.x() - 0.5 * p.y(); });
  const Eigen::Vector2d center(140.25, 50.5);
  const Patch patch = PatchAt(level, center);
  for (int y = 0; y < Patch::kWidth; ++y) {
    for (int x = 0; x < Patch::kWidth; ++x) {
      const Eigen::Vector2d p = center + kSteps * Eigen::Vector2d(x - 6, y - 6);
      // Half a grey level of the image's rounding, and of the patch's.
      EXPECT_NEAR(patch.gray[y * Patch::kWidth + x], p.x() - 0.5 * p.y(), 1.01) << x << " " << y;
    }
  }
}

TEST(AlignPatch, FindsAShiftOfAFractionOfAPixelUnderOtherLight) {
  const Patch patch = PatchAt(Draw(Clouds), kCenter);
  for (const Eigen::Vector2d& shift :
       {Eigen::Vector2d(0.31, -0.44), Eigen::Vector2d(-0.62, 0.13)}) {
    const PyramidLevel moved =
        Draw([&](const Eigen::Vector2d& p) -> double { return 30 + 0.6 * Clouds(p - shift); });
    const auto found = AlignFlat(patch, moved, {kCenter, kSteps});
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - kCenter - shift).norm(), 0.03) << shift.transpose();
  }
}

TEST(AlignPatch, FindsWhatIsTurnedLargerAndSlanted) {
  const Patch patch = PatchAt(Draw(Clouds), kCenter);
  Eigen::Matrix2d warp = Eigen::Rotation2Dd(0.4).toRotationMatrix() * 1.3;
  warp.col(0) *= 0.8;
  const Eigen::Vector2d truth(60.2, 70.6);
  const Eigen::Matrix2d inverse = warp.inverse();
  const PyramidLevel warped = Draw(
      [&](const Eigen::Vector2d& p) -> double { return Clouds(kCenter + inverse * (p - truth)); });
  const auto found = AlignFlat(patch, warped, {truth + Eigen::Vector2d(0.5, -0.4), warp * kSteps});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - truth).norm(), 0.05);
}

// A plane whose steps are `stretch` times its slope more than those of one that faces the camera.
struct Slanted {
  Eigen::Vector2d stretch{4.0, 1.5};  // pixels
  Eigen::Vector2d slope{0.03, -0.05};
  Eigen::Vector2d truth{60.2, 70.6};
  Patch patch = PatchAt(Draw(Clouds), kCenter);
  PyramidLevel level = Drawn();

  PyramidLevel Drawn() const {
    const Eigen::Matrix2d to_samples = (kSteps + stretch * slope.transpose()).inverse();
    return Draw([&](const Eigen::Vector2d& p) -> double {
      return Clouds(kCenter + kSteps * to_samples * (p - truth));
    });
  }

  std::optional<AlignedPatch> Align(const Eigen::Vector2d& mean, double sigma) const {
    const PatchGrid guess{truth + Eigen::Vector2d(0.4, -0.3), kSteps + stretch * mean.transpose()};
    return AlignPatch(patch, level, guess, stretch,
                      {mean, Eigen::Matrix2d::Identity() / (sigma * sigma)});
  }
};

TEST(AlignPatch, FindsTheSlopeOfASurfaceWithItsCentre) {
  const Slanted scene;
  const auto found = scene.Align(Eigen::Vector2d::Zero(), 0.2);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((found->center - scene.truth).norm(), 0.03);
  const Eigen::Vector2d error = found->slope.mean - scene.slope;
  EXPECT_LT(error.norm(), 0.1 * scene.slope.norm());
  // It is as certain as that.
  EXPECT_LT(error.dot(found->slope.information * error), 9.2);  // chi squared, 99 %
}

TEST(AlignPatch, KeepsASlopeThatIsKnown) {
  const Slanted scene;
  const auto found = scene.Align(scene.slope, 1e-6);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((found->center - scene.truth).norm(), 0.03);
  EXPECT_LT((found->slope.mean - scene.slope).norm(), 1e-4);
}

TEST(AlignPatch, GivesTheSlopeOnlyWhatTheImageTellsOfIt) {
  const Slanted scene;
  const auto found = scene.Align(Eigen::Vector2d::Zero(), 0.2);
  ASSERT_TRUE(found.has_value());
  const Eigen::Matrix2d added = found->slope.information - Eigen::Matrix2d::Identity() / 0.04;
  EXPECT_GT(added.eigenvalues().real().minCoeff(), 0);
  Slanted nearby;  // from half as far away from where the patch was taken
  nearby.stretch *= 0.5;
  nearby.slope *= 2;  // looks the same
  const auto less = nearby.Align(Eigen::Vector2d::Zero(), 0.2);
  ASSERT_TRUE(less.has_value());
  const Eigen::Matrix2d quarter = less->slope.information - Eigen::Matrix2d::Identity() / 0.04;
  EXPECT_LT((4 * quarter - added).norm(), 0.2 * added.norm());
}

// Planes that are seen much flatter, or much less flat, than where the patch was taken.
TEST(AlignPatch, FollowsSurfacesThatAreSquashedAndStretched) {
  for (const double growth : {0.45, 0.7, 1.8}) {
    Slanted scene;
    const Eigen::Vector2d moved = kSteps.inverse() * scene.stretch;
    scene.slope = (growth - 1) * moved / moved.squaredNorm();  // determinant 1 + moved^T slope
    scene.level = scene.Drawn();
    const auto found = scene.Align(Eigen::Vector2d::Zero(), 0.5);
    ASSERT_TRUE(found.has_value()) << growth;
    EXPECT_LT((found->center - scene.truth).norm(), 0.05) << growth;
    EXPECT_LT((found->slope.mean - scene.slope).norm(), 0.1 * scene.slope.norm()) << growth;
  }
}

TEST(AlignPatch, RefusesASurfaceSeenFromBehind) {
  const Patch patch = PatchAt(Draw(Clouds), kCenter);
  const PyramidLevel mirrored = Draw([](const Eigen::Vector2d& p) -> double {
    return Clouds({p.x(), 2 * kCenter.y() - p.y()});
  });
  const Eigen::Matrix2d from_behind = kSteps * Eigen::Vector2d(1, -1).asDiagonal();
  EXPECT_FALSE(AlignFlat(patch, mirrored, {kCenter, from_behind}).has_value());
}

TEST(AlignPatch, GoesOnAcrossTheSeam) {
  const auto rolled = [](double by) {
    return Draw([by](const Eigen::Vector2d& p) -> double {
      const double from_center = std::remainder(p.x() - by, kWidth);
      return Clouds({kCenter.x() + from_center, p.y()});
    });
  };
  const Patch patch = PatchAt(rolled(kCenter.x()), kCenter);
  const auto found = AlignFlat(patch, rolled(0.2), {{255.9, kCenter.y()}, kSteps});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->x(), kWidth + 0.2, 0.03);
  EXPECT_NEAR(found->y(), kCenter.y(), 0.03);
}

TEST(AlignPatch, RefusesWhatDoesNotLookAlike) {
  const PyramidLevel level = Draw(Clouds);
  const Patch patch = PatchAt(level, kCenter);
  EXPECT_FALSE(AlignFlat(patch, level, {{40.0, 40.0}, kSteps}).has_value());
  EXPECT_FALSE(AlignFlat(patch,
                         Draw([](const Eigen::Vector2d& p) -> double { return 255 - Clouds(p); }),
                         {kCenter, kSteps})
                   .has_value());
}

TEST(AlignPatch, RefusesAGuessThatIsFartherOffThanTwoSamples) {
  const PyramidLevel level = Draw(Clouds);
  const Patch patch = PatchAt(level, kCenter);
  EXPECT_TRUE(AlignFlat(patch, level, {kCenter + Eigen::Vector2d(0.9, 0), kSteps}).has_value());
  EXPECT_FALSE(AlignFlat(patch, level, {kCenter + Eigen::Vector2d(1.2, 0), kSteps}).has_value());
}

TEST(AlignPatch, RefusesWhatIsEvenAndEdgesThatLeaveOneDirectionOpen) {
  const PyramidLevel even = Draw([](const Eigen::Vector2d&) { return 90.0; });
  EXPECT_FALSE(AlignFlat(PatchAt(even, kCenter), even, {kCenter, kSteps}).has_value());
  const PyramidLevel edge =
      Draw([](const Eigen::Vector2d& p) { return 90 + 60 * std::tanh(p.x() - kCenter.x()); });
  EXPECT_FALSE(AlignFlat(PatchAt(edge, kCenter), edge, {kCenter, kSteps}).has_value());
  const PyramidLevel clouds = Draw(Clouds);
  EXPECT_FALSE(AlignFlat(PatchAt(clouds, kCenter), even, {kCenter, kSteps}).has_value());
}

TEST(AlignPatch, RefusesWhatReachesBeyondTheMargin) {
  const PyramidLevel level = Draw(Clouds);
  const Patch patch = PatchAt(level, kCenter);
  const Eigen::Matrix2d wide = 6.0 * Eigen::Matrix2d::Identity();
  EXPECT_FALSE(SamplePatch(level, {{2.0, 60.0}, wide}).has_value());
  EXPECT_FALSE(AlignFlat(patch, level, {{2.0, 60.0}, wide}).has_value());
  EXPECT_FALSE(AlignFlat(patch, level, {{100.0, 126.0}, wide}).has_value());
  const Eigen::Matrix2d none = kSteps * std::nan("");
  EXPECT_FALSE(AlignFlat(patch, level, {kCenter, none}).has_value());
}

}  // namespace
}  // namespace orb360
