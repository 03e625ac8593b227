#include "slam/io/lenses/lens_calibration.h"

#include <cstdlib>
#include <filesystem>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/io/lenses/dual_fisheye_stitcher.h"
#include "slam/io/lenses/lens_presets.h"
#include "tests/slam/io/lenses/rendered_fisheye.h"
#include "tests/slam/io/lenses/rendered_lens.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kRadian = std::numbers::pi / 180.0;

/// Two different lenses of which nothing is ideal.
LensCalibration Uneven() {
  LensCalibration calibration;
  FisheyeLens& first = calibration.lenses[0];
  first.size = {400, 380};
  first.center = {203.0, 186.5};
  first.focal = 108.0;
  first.polynomial = {0.02, -0.01, 0.001, 0.0002};
  first.field_of_view = 196.0 * kRadian;
  first.camera_from_lens = Eigen::AngleAxisd(0.05, Eigen::Vector3d(0.3, 0.5, 0.8).normalized());
  FisheyeLens& second = calibration.lenses[1];
  second = first;
  second.center = {198.0, 191.0};
  second.focal = 110.0;
  second.polynomial = {0.0, 0.0, 0.0, 0.0};
  second.field_of_view = 200.0 * kRadian;
  second.camera_from_lens = Eigen::AngleAxisd(3.1, Eigen::Vector3d(0.01, 1.0, 0.02).normalized());
  return calibration;
}

SphereStitcher StitcherOf(const LensCalibration& calibration, cv::Size sphere) {
  return SphereStitcher(sphere, {calibration.lenses[0].size, calibration.lenses[1].size},
                        DualFisheyeSampler(calibration));
}

TEST(DualFisheye, StitchesWhatBothLensesWereRenderedWith) {
  const LensCalibration calibration = Uneven();
  const cv::Mat images[] = {RenderFisheye(calibration.lenses[0], SphereColor),
                            RenderFisheye(calibration.lenses[1], SphereColor)};
  const SphereStitcher stitcher = StitcherOf(calibration, {640, 320});
  EXPECT_TRUE(stitcher.coverage().empty());
  const cv::Mat sphere = stitcher.Stitch(images, false);
  EXPECT_LE(cv::norm(sphere, RenderSphere({640, 320}), cv::NORM_INF), 6.0);
}

TEST(DualFisheye, BothLensesAreBlendedWithinADegreeOfWhereTheyMeet) {
  const StitchSampler sampler = DualFisheyeSampler(LensPreset("samsung-gear360").value());
  for (const auto& [degrees, weight] :
       {std::pair(88.5, 1.0), {89.5, 0.75}, {90.0, 0.5}, {90.5, 0.25}, {91.5, 0.0}}) {
    const double angle = degrees * kRadian;  // from the axis of the first lens, which looks ahead
    std::vector<StitchSample> samples;
    sampler({-std::cos(angle), std::sin(angle), 0}, &samples);
    ASSERT_EQ(samples.size(), 2U);
    EXPECT_EQ(samples[0].image, 0);
    EXPECT_NEAR(samples[0].weight, weight, 1e-9) << degrees;
    EXPECT_NEAR(samples[1].weight, 1 - weight, 1e-9) << degrees;
  }
}

TEST(DualFisheye, ACalibrationOfAGiganticSphereIsRefusedBeforeItTakesMemory) {
  LensCalibration calibration = Uneven();
  calibration.lenses[0].focal = 16000;
  const std::vector<cv::Size> sizes = {calibration.lenses[0].size, calibration.lenses[1].size};
  EXPECT_THAT(MessageOf<UserError>([&] { MakeDualFisheyeStitcher(calibration, sizes, "a.insv"); }),
              AllOf(HasSubstr("a.insv"), HasSubstr("limited to 32000"), HasSubstr("focal")));
}

TEST(DualFisheye, LensesOfOtherExposureAreMadeEqual) {
  const LensCalibration calibration = Uneven();
  const cv::Mat images[] = {RenderFisheye(calibration.lenses[0], SphereColor) * 0.7,
                            RenderFisheye(calibration.lenses[1], SphereColor)};
  const cv::Mat sphere = StitcherOf(calibration, {640, 320}).Stitch(images, true);
  const cv::Mat expected = RenderSphere({640, 320}) * std::sqrt(0.7);
  EXPECT_LE(cv::norm(sphere, expected, cv::NORM_L1) / (3.0 * expected.total()), 3.0);
}

TEST(DualFisheye, WhatNoLensShowsIsBlackAndNotCovered) {
  LensCalibration calibration = Uneven();
  for (FisheyeLens& lens : calibration.lenses) lens.field_of_view = 160.0 * kRadian;
  const cv::Mat images[] = {RenderFisheye(calibration.lenses[0], SphereColor),
                            RenderFisheye(calibration.lenses[1], SphereColor)};
  const SphereStitcher stitcher = StitcherOf(calibration, {640, 320});
  const cv::Mat sphere = stitcher.Stitch(images, true);
  // Two circles of 80 degrees' radius cover 1 - cos(80 degrees) of the sphere.
  double covered = 0.0;
  for (int row = 0; row < 320; ++row) {
    covered += cv::countNonZero(stitcher.coverage().row(row)) *
               std::sin(std::numbers::pi * (row + 0.5) / 320) * std::numbers::pi / (2 * 320 * 640);
  }
  EXPECT_NEAR(covered, 1.0 - std::cos(80.0 * kRadian), 0.01);
  cv::Mat gray;
  cv::cvtColor(sphere, gray, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(cv::norm((gray > 0) != (stitcher.coverage() > 0), cv::NORM_INF), 0.0);
}

TEST(DualFisheye, LensesApartAgreeAtTheDistance) {
  LensCalibration calibration = Uneven();
  calibration.distance = 0.5;
  calibration.lenses[0].position = {0.0, 0.0, 0.03};
  calibration.lenses[1].position = {0.0, 0.0, -0.03};
  // A sphere of half a metre around the camera, as each lens sees it.
  cv::Mat images[2];
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d& p = calibration.lenses[i].position;
    const Eigen::Vector3d lens(-p.z(), p.x(), -p.y());
    images[i] = RenderFisheye(calibration.lenses[i], [&](const Eigen::Vector3d& ray) {
      const double along = ray.dot(lens);
      const double range = -along + std::sqrt(along * along - lens.squaredNorm() + 0.25);
      return SphereColor((lens + range * ray).normalized());
    });
  }
  const cv::Mat expected = RenderSphere({640, 320});
  EXPECT_LE(
      cv::norm(StitcherOf(calibration, {640, 320}).Stitch(images, false), expected, cv::NORM_INF),
      6.0);
  calibration.distance = 0.0;
  EXPECT_GT(
      cv::norm(StitcherOf(calibration, {640, 320}).Stitch(images, false), expected, cv::NORM_INF),
      6.0);
}

TEST(DualFisheye, AgreesWithTheFilterV360OfFfmpeg) {
  if (std::system("command -v ffmpeg > /dev/null") != 0) {
    GTEST_SKIP() << "there is no program ffmpeg (Debian package ffmpeg)";
  }
  const TempFolder folder;
  const cv::Mat sphere = RenderSphere({1024, 512});
  cv::imwrite((folder / "sphere.png").string(), sphere);
  const LensCalibration calibration =
      ScaledTo(LensPreset("samsung-gear360").value(), {{500, 500}, {500, 500}}, "video");
  cv::Mat images[2];
  for (int i = 0; i < 2; ++i) {
    const std::string image = (folder / "fisheye.png").string();
    const std::string command =
        "ffmpeg -v error -y -i " + (folder / "sphere.png").string() +
        " -vf v360=e:fisheye:h_fov=195:v_fov=195:w=500:h=500:yaw=" + (i == 0 ? "0" : "180") +
        " -frames:v 1 " + image;
    ASSERT_EQ(std::system(command.c_str()), 0);
    images[i] = cv::imread(image);
  }
  const cv::Mat stitched = StitcherOf(calibration, {1024, 512}).Stitch(images, false);
  EXPECT_LE(MedianColorDifference(stitched, sphere), 1.5);
  EXPECT_LE(cv::norm(stitched, sphere, cv::NORM_L1) / (3.0 * sphere.total()), 2.0);
}

class DualFisheyeOfGoProFusion : public testing::TestWithParam<int> {};

// The other stitcher used the same parameters, and no match of exposure.
TEST_P(DualFisheyeOfGoProFusion, AgreesWithAnotherStitcher) {
  const std::filesystem::path folder =
      std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/data/lens_formats/dual_fisheye";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const auto load = [&](const std::string& name) {
    return cv::imread((folder / ("frame" + std::to_string(GetParam()) + name)).string());
  };
  const cv::Mat images[] = {load("_front.jpg"), load("_back.jpg")};
  const cv::Mat reference = load("_stitched.jpg");
  const SphereStitcher stitcher = StitcherOf(LensPreset("gopro-fusion").value(), reference.size());
  const cv::Mat sphere = stitcher.Stitch(images, false);
  const FeatureErrors errors = CompareFeatures(sphere, reference);
  const double difference = MedianColorDifference(sphere, reference);
  std::printf("frame %d: %d features, median %.3f, 90th percentile %.3f degrees, colour %.2f\n",
              GetParam(), errors.count, errors.median, errors.percentile, difference);
  EXPECT_GT(errors.count, 1000);
  EXPECT_LT(errors.percentile, 0.2);
  EXPECT_LT(difference, 4.0);
}

INSTANTIATE_TEST_SUITE_P(Frames, DualFisheyeOfGoProFusion, testing::Range(1, 6));

TEST(LensCalibrationFile, IsReadAsItWasWritten) {
  const TempFolder folder;
  LensCalibration calibration = Uneven();
  calibration.distance = 2.5;
  calibration.lenses[1].position = {0.01, 0.0, -0.03};
  calibration.is_side_by_side = true;
  WriteText(folder / "lens.yaml", ToYaml(calibration));
  const LensCalibration read = FindLensCalibration((folder / "lens.yaml").string());
  EXPECT_TRUE(read.is_side_by_side);
  EXPECT_EQ(read.distance, 2.5);
  for (int i = 0; i < 2; ++i) {
    const FisheyeLens& a = calibration.lenses[i];
    const FisheyeLens& b = read.lenses[i];
    EXPECT_EQ(a.size, b.size);
    EXPECT_EQ(a.center, b.center);
    EXPECT_EQ(a.focal, b.focal);
    EXPECT_EQ(a.polynomial, b.polynomial);
    EXPECT_NEAR(a.field_of_view, b.field_of_view, 1e-12);
    EXPECT_LT(a.camera_from_lens.angularDistance(b.camera_from_lens), 1e-9);
    EXPECT_EQ(a.position, b.position);
  }
}

TEST(LensCalibrationFile, IsRefusedByLineForWhatItMustNotSay) {
  const TempFolder folder;
  const std::string good = ToYaml(Uneven());
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string yaml = good;
    const size_t at = yaml.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    WriteText(folder / "lens.yaml", yaml.replace(at, from.size(), to));
    return MessageOf<UserError>([&] { ReadLensCalibration(folder / "lens.yaml"); });
  };
  EXPECT_THAT(refusal("dual_fisheye", "pinhole"), HasSubstr("lens.yaml:2: model must be"));
  EXPECT_THAT(refusal("two_tracks", "three"), HasSubstr("lens.yaml:3: layout must be"));
  EXPECT_THAT(refusal("focal", "focus"), HasSubstr("unknown key `focus` of lens 1"));
  EXPECT_THAT(refusal("    focal: 108\n", ""), HasSubstr("focal of lens 1 is missing"));
  EXPECT_THAT(refusal("[203, 186.5]", "[203]"),
              HasSubstr("lens.yaml:7: center of lens 1 must be 2"));
  EXPECT_THAT(refusal("196", "nan"), HasSubstr("field_of_view of lens 1 must be a number"));
  EXPECT_THAT(refusal("[0.02, -0.01", "[-2, -0.01"), HasSubstr("radius shrink"));
  EXPECT_THAT(refusal("rotation: [", "rotation: [0.9, "), HasSubstr("must be 4 numbers"));
  EXPECT_THAT(MessageOf<UserError>([&] { FindLensCalibration("nokia"); }),
              AllOf(HasSubstr("`nokia`"), HasSubstr("gopro-fusion")));
}

TEST(LensCalibrationFile, FitsScaledImagesAndNoOthers) {
  const LensCalibration scaled = ScaledTo(Uneven(), {{800, 760}, {800, 760}}, "video");
  EXPECT_DOUBLE_EQ(scaled.lenses[0].focal, 216.0);
  EXPECT_DOUBLE_EQ(scaled.lenses[0].center.x(), 406.0);
  EXPECT_THAT(MessageOf<UserError>([&] {
                ScaledTo(Uneven(), {{800, 760}, {800, 800}}, "video");
              }),
              AllOf(HasSubstr("video: the image of lens 2 is 800x800"), HasSubstr("400x380")));
}

}  // namespace
}  // namespace orb360
