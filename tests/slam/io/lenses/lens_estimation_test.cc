#include "slam/io/lenses/lens_estimation.h"

#include <filesystem>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "slam/io/lenses/calibrate_lenses.h"
#include "slam/io/lenses/dual_fisheye_video.h"
#include "slam/io/lenses/lens_presets.h"
#include "tests/slam/io/lenses/rendered_fisheye.h"
#include "tests/slam/io/lenses/rendered_lens.h"
#include "tests/slam/io/positions/insta360_writer.h"
#include "tests/slam/io/temp_folder.h"
#include "tests/slam/io/video/write_video.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/sequence.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Two equal lenses as a preset would describe them.
LensCalibration Ideal() {
  LensCalibration calibration =
      ScaledTo(LensPreset("samsung-gear360").value(), {{640, 640}, {640, 640}}, "lens");
  calibration.is_side_by_side = false;
  return calibration;
}

/// A camera of that kind as it was really built.
LensCalibration Built() {
  LensCalibration calibration = Ideal();
  calibration.lenses[0].center += Eigen::Vector2d(2.0, -1.0);
  calibration.lenses[1].center += Eigen::Vector2d(-1.5, 2.5);
  calibration.lenses[1].focal *= 1.004;
  calibration.lenses[1].camera_from_lens =
      Eigen::Quaterniond(
          Eigen::AngleAxisd(1.2 * kDegree, Eigen::Vector3d(0.5, 0.3, 0.8).normalized())) *
      calibration.lenses[1].camera_from_lens;
  return calibration;
}

TEST(FisheyeLens, UnprojectsWhatItProjects) {
  FisheyeLens lens = Built().lenses[1];
  lens.polynomial = {0.02, -0.01, 0.001, 0.0002};
  for (const Eigen::Vector3d& ray : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 2, 3),
                                     Eigen::Vector3d(-1, 0.2, -0.1), Eigen::Vector3d(0.5, -2, 0)}) {
    EXPECT_LT((Unproject(lens, Project(lens, ray)) - ray.normalized()).norm(), 1e-9);
  }
}

TEST(LensEstimation, FindsTheLensesFromWhatBothShow) {
  const LensCalibration built = Built();
  std::vector<LensMatch> matches;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const TexturedSphere sphere(seed);
    const cv::Mat images[] = {RenderFisheye(built.lenses[0], sphere),
                              RenderFisheye(built.lenses[1], sphere)};
    const std::vector<LensMatch> more = MatchOverlap(Ideal(), images);
    matches.insert(matches.end(), more.begin(), more.end());
  }
  const std::optional<LensEstimate> estimate = EstimateLenses(Ideal(), matches);
  ASSERT_TRUE(estimate);
  EXPECT_GT(estimate->median_before, 0.8 * kDegree);
  EXPECT_LT(estimate->median_after, 0.1 * kDegree);
  // What counts is where both lenses meet: each is rendered as built and stitched as estimated.
  const cv::Mat images[] = {RenderFisheye(built.lenses[0], SphereColor),
                            RenderFisheye(built.lenses[1], SphereColor)};
  double errors[2] = {};
  for (int i = 0; i < 2; ++i) {
    const LensCalibration& calibration = i == 0 ? Ideal() : estimate->calibration;
    double sum = 0.0;
    for (int step = 0; step < 360; ++step) {
      const double around = step * kDegree;
      const Eigen::Vector3d ray(std::cos(around), std::sin(around), 0.0);  // of the seam, optical
      const auto seen = [&](int lens) {
        const Eigen::Vector2d pixel = Project(
            calibration.lenses[lens], calibration.lenses[lens].camera_from_lens.conjugate() * ray);
        return Eigen::Vector3d(built.lenses[lens].camera_from_lens *
                               Unproject(built.lenses[lens], pixel));
      };
      sum += (seen(0) - seen(1)).norm() / kDegree / 360;
    }
    errors[i] = sum;
  }
  EXPECT_GT(errors[0], 0.8);
  EXPECT_LT(errors[1], 0.1);
}

TEST(LensEstimation, OutliersDoNotMoveIt) {
  const LensCalibration built = Built();
  cv::RNG random(3);
  std::vector<LensMatch> matches;
  for (int i = 0; i < 400; ++i) {
    const double around = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double angle = random.uniform(85.0, 95.0) * kDegree;
    const Eigen::Vector3d ray(std::sin(angle) * std::cos(around),
                              std::sin(angle) * std::sin(around), std::cos(angle));
    LensMatch match;
    for (int lens = 0; lens < 2; ++lens) {
      match.pixel[lens] =
          Project(built.lenses[lens], built.lenses[lens].camera_from_lens.conjugate() * ray);
    }
    if (i % 4 == 0) match.pixel[1] += Eigen::Vector2d(random.uniform(-15, 15), 12.0);
    matches.push_back(match);
  }
  const std::optional<LensEstimate> estimate = EstimateLenses(Ideal(), matches);
  ASSERT_TRUE(estimate);
  EXPECT_LT(estimate->median_after, 0.03 * kDegree);
  EXPECT_FALSE(EstimateLenses(Ideal(), std::span(matches).first(49)));
}

TEST(LensCalibration, IsEstimatedFromAVideoAndUsedForTheNext) {
  const LensCalibration built = Built();
  TrackSpec tracks[2];
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const TexturedSphere sphere(seed);
    for (int lens = 0; lens < 2; ++lens) {
      tracks[lens].images.push_back(RenderFisheye(built.lenses[lens], sphere));
    }
  }
  const TempFolder folder;
  WriteVideoFile(folder / "GPFR0001.MP4", {tracks[0]});
  const std::string video = (folder / "GPFR0001.MP4").string();
  EXPECT_THAT(MessageOf<UserError>([&] { CalibrateLenses(video, Ideal()); }),
              AllOf(HasSubstr("GPBK0001.MP4 is not there")));
  WriteVideoFile(folder / "GPBK0001.MP4", {tracks[1]});
  const LensEstimate estimate = CalibrateLenses(video, Ideal());
  EXPECT_LT(estimate.median_after, 0.15 * kDegree);
  WriteText(folder / "lens.yaml", ToYaml(estimate.calibration));
  SequenceOptions options;
  options.lens = (folder / "lens.yaml").string();
  for (const char* name : {"GPFR0001.MP4", "GPBK0001.MP4"}) {
    const auto sequence = OpenSequence((folder / name).string(), options);
    EXPECT_EQ(sequence->image_size().width, 2 * sequence->image_size().height);
    int count = 0;
    while (const std::optional<Frame> frame = sequence->Next()) {
      EXPECT_EQ(frame->image.size(), sequence->image_size());
      ++count;
    }
    EXPECT_EQ(count, 3);
  }
}

TEST(LensCalibration, IsEstimatedFromAFolderOfImagesWithBothLensesSideBySide) {
  LensCalibration start = Ideal();
  start.is_side_by_side = true;
  const LensCalibration built = Built();
  const TempFolder folder;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const TexturedSphere sphere(seed);
    cv::Mat image;
    cv::hconcat(RenderFisheye(built.lenses[0], sphere), RenderFisheye(built.lenses[1], sphere),
                image);
    std::vector<unsigned char> jpeg;
    cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, 98});
    // The camera appends its own records to the JPEG file.
    WriteText(folder / ("IMG_" + std::to_string(seed) + "_00_001.insp"),
              std::string(jpeg.begin(), jpeg.end()) + Insta360Trailer({{1, "serial"}}));
  }
  const std::string input = folder.path().string();
  EXPECT_THAT(MessageOf<UserError>([&] { CalibrateLenses(input, Ideal()); }),
              AllOf(HasSubstr(input), HasSubstr("side by side")));
  const LensEstimate estimate = CalibrateLenses(input, start);
  EXPECT_LT(estimate.median_after, 0.15 * kDegree);

  EXPECT_THAT(MessageOf<UserError>([&] { OpenSequence(input, {}); }),
              AllOf(HasSubstr("IMG_1_00_001.insp"), HasSubstr("--lens insta360-side-by-side")));
  SequenceOptions options;
  options.lens = (folder / "lens.yaml").string();
  WriteText(options.lens, ToYaml(estimate.calibration));
  const auto sequence = OpenSequence(input, options);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::optional<Frame> frame = sequence->Next();
    ASSERT_TRUE(frame);
    const cv::Mat expected = RenderSphere(frame->image.size(), TexturedSphere(seed));
    EXPECT_LT(MedianColorDifference(frame->image, expected), 10.0);
  }
  EXPECT_FALSE(sequence->Next());
}

TEST(LensCalibration, BlankImagesAreRefused) {
  const TempFolder folder;
  TrackSpec blank;
  blank.images.assign(2, cv::Mat(640, 640, CV_8UC3, cv::Scalar::all(90)));
  WriteVideoFile(folder / "two.mp4", {blank, blank});
  EXPECT_THAT(
      MessageOf<UserError>([&] { CalibrateLenses((folder / "two.mp4").string(), Ideal()); }),
      AllOf(HasSubstr("two.mp4"), HasSubstr("texture")));
}

// The parameters of the preset miss by 1.5 degrees where the lenses of this camera meet.
TEST(LensEstimation, BringsTheLensesOfAGoProFusionTogether) {
  const std::filesystem::path folder =
      std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/data/lens_formats/dual_fisheye";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const LensCalibration preset = LensPreset("gopro-fusion").value();
  std::vector<LensMatch> matches;
  for (int frame = 1; frame <= 5; ++frame) {
    const std::string name = (folder / ("frame" + std::to_string(frame))).string();
    const cv::Mat images[] = {cv::imread(name + "_front.jpg"), cv::imread(name + "_back.jpg")};
    const std::vector<LensMatch> more = MatchOverlap(preset, images);
    matches.insert(matches.end(), more.begin(), more.end());
  }
  const std::optional<LensEstimate> estimate = EstimateLenses(preset, matches);
  ASSERT_TRUE(estimate);
  std::printf("%d matches, median %.3f before, %.3f degrees after\n", estimate->num_matches,
              estimate->median_before / kDegree, estimate->median_after / kDegree);
  EXPECT_GT(estimate->median_before, 1.0 * kDegree);
  EXPECT_LT(estimate->median_after, 0.2 * kDegree);
}

}  // namespace
}  // namespace orb360
