#include "slam/io/lenses/eac.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/slam/io/lenses/rendered_lens.h"
#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

TEST(EacLayout, IsThatOfTheCamerasSizesOnly) {
  const auto expect = [](cv::Size track, int face, int overlap) {
    const std::optional<EacLayout> layout = EacLayoutOf(track);
    ASSERT_TRUE(layout) << track;
    EXPECT_EQ(layout->face, face);
    EXPECT_EQ(layout->overlap, overlap);
  };
  expect({2272, 736}, 736, 16);
  expect({4096, 1344}, 1344, 16);
  expect({5888, 1920}, 1920, 32);
  for (const cv::Size size : {cv::Size(2208, 736), cv::Size(1920, 1080), cv::Size(2048, 1024),
                              cv::Size(0, 0), cv::Size(4096, 736)}) {
    EXPECT_FALSE(EacLayoutOf(size)) << size;
  }
}

/// Track `number` of an EAC recording of SphereColor, written down face by face: each as its own
/// function of the angles from its centre, in the order in which a viewer of the camera sees them.
cv::Mat RenderTrack(int number, const EacLayout& layout) {
  const int outer = layout.face + 2 * layout.overlap;
  const auto bearing = [&](double x, double y) -> std::optional<Eigen::Vector3d> {
    int place = 0;
    if (x > outer) {
      place = 1;
      x -= outer;
      if (x > layout.face) {
        place = 2;
        x -= layout.face;
      }
    }
    if (place != 1 && x > outer / 2) x -= 2 * layout.overlap;
    const double a = std::tan(std::numbers::pi / 2 * (x / layout.face - 0.5));  // to the right
    const double b = std::tan(std::numbers::pi / 2 * (y / layout.face - 0.5));  // downwards
    const Eigen::Vector3d forward(-1, 0, 0);
    const Eigen::Vector3d right(0, 1, 0);
    const Eigen::Vector3d up(0, 0, 1);
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();
    if (number == 0 && place == 0) ray = -right + a * forward - b * up;
    if (number == 0 && place == 1) ray = forward + a * right - b * up;
    if (number == 0 && place == 2) ray = right - a * forward - b * up;
    if (number == 1 && place == 0) ray = -up - a * forward - b * right;
    if (number == 1 && place == 1) ray = -forward + a * up - b * right;
    if (number == 1 && place == 2) ray = up + a * forward - b * right;
    return ray.normalized();
  };
  return RenderLens({3 * layout.face + 4 * layout.overlap, layout.face}, bearing);
}

TEST(Eac, StitchesWhatWasRenderedOnItsFaces) {
  const EacLayout layout{184, 4};
  const cv::Mat tracks[] = {RenderTrack(0, layout), RenderTrack(1, layout)};
  const SphereStitcher stitcher(layout.sphere(), {tracks[0].size(), tracks[1].size()},
                                EacSampler(layout));
  EXPECT_TRUE(stitcher.coverage().empty());
  const cv::Mat sphere = stitcher.Stitch(tracks, false);
  const cv::Mat expected = RenderSphere(layout.sphere());
  EXPECT_LE(cv::norm(sphere, expected, cv::NORM_INF), 4.0);
}

TEST(Eac, BlendsTheLensesAcrossTheSeam) {
  const EacLayout layout{184, 8};
  cv::Mat tracks[] = {RenderTrack(0, layout), RenderTrack(1, layout)};
  const int outer = layout.face + 2 * layout.overlap;
  // The lens that looks backwards gives black.
  tracks[0].colRange(0, outer / 2) = cv::Scalar::all(0);
  tracks[0].colRange(tracks[0].cols - outer / 2, tracks[0].cols) = cv::Scalar::all(0);
  const SphereStitcher stitcher(layout.sphere(), {tracks[0].size(), tracks[1].size()},
                                EacSampler(layout));
  const cv::Mat sphere = stitcher.Stitch(tracks, false);
  const cv::Mat expected = RenderSphere(layout.sphere());
  const int row = layout.face;  // the horizon
  double last = 0.0;
  for (int col = 0; col < layout.face; ++col) {  // from the left backwards to the front
    const double ratio = 1.0 * sphere.at<cv::Vec3b>(row, col + layout.face / 2)[1] /
                         expected.at<cv::Vec3b>(row, col + layout.face / 2)[1];
    EXPECT_GE(ratio, last - 0.03);
    const double column_of_face = col + 0.5 - 0.5 * layout.face;
    const double expected_ratio = 0.5 + column_of_face / (2.0 * layout.overlap);
    EXPECT_NEAR(ratio, std::clamp(expected_ratio, 0.0, 1.0), 0.06) << col;
    last = ratio;
  }
}

/// Tracks with overlap from the six faces of FFmpeg's layout "eac", which has none.
cv::Mat WithOverlap(const cv::Mat& faces, int overlap) {
  const int face = faces.rows;
  const auto outer = [&](int first) {
    const cv::Mat columns = faces.colRange(first, first + face);
    cv::Mat result;
    cv::hconcat(columns.colRange(0, face / 2 + overlap), columns.colRange(face / 2 - overlap, face),
                result);
    return result;
  };
  cv::Mat track;
  cv::hconcat(std::vector<cv::Mat>{outer(0), faces.colRange(face, 2 * face), outer(2 * face)},
              track);
  return track;
}

TEST(Eac, AgreesWithTheFilterV360OfFfmpeg) {
  if (std::system("command -v ffmpeg > /dev/null") != 0) {
    GTEST_SKIP() << "there is no program ffmpeg (Debian package ffmpeg)";
  }
  const TempFolder folder;
  const EacLayout layout{368, 8};
  const cv::Mat sphere = RenderSphere(layout.sphere());
  cv::imwrite((folder / "sphere.png").string(), sphere);
  const std::string command = "ffmpeg -v error -i " + (folder / "sphere.png").string() +
                              " -vf v360=e:eac:w=1104:h=736 -frames:v 1 " +
                              (folder / "eac.png").string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  const cv::Mat eac = cv::imread((folder / "eac.png").string());
  ASSERT_EQ(eac.size(), cv::Size(3 * layout.face, 2 * layout.face));
  const cv::Mat tracks[] = {
      WithOverlap(eac.rowRange(0, layout.face), layout.overlap),
      WithOverlap(eac.rowRange(layout.face, 2 * layout.face), layout.overlap)};
  const SphereStitcher stitcher(layout.sphere(), {tracks[0].size(), tracks[1].size()},
                                EacSampler(layout));
  const cv::Mat stitched = stitcher.Stitch(tracks, false);
  EXPECT_LE(MedianColorDifference(stitched, sphere), 1.0);
  EXPECT_LE(cv::norm(stitched, sphere, cv::NORM_L1) / (3.0 * sphere.total()), 1.5);
}

class EacOfGoProMax : public testing::TestWithParam<int> {};

TEST_P(EacOfGoProMax, AgreesWithAnotherStitcher) {
  const std::filesystem::path folder =
      std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/data/lens_formats/eac";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const auto load = [&](const std::string& name) {
    return cv::imread((folder / ("frame" + std::to_string(GetParam()) + name)).string());
  };
  const cv::Mat tracks[] = {load("_track0.jpg"), load("_track5.jpg")};
  const EacLayout layout = EacLayoutOf(tracks[0].size()).value();
  const SphereStitcher stitcher(layout.sphere(), {tracks[0].size(), tracks[1].size()},
                                EacSampler(layout));
  const cv::Mat reference = load("_STITCHED.jpg");
  cv::Mat sphere;
  cv::resize(stitcher.Stitch(tracks, false), sphere, reference.size(), 0, 0, cv::INTER_AREA);
  const FeatureErrors errors = CompareFeatures(sphere, reference);
  const double difference = MedianColorDifference(sphere, reference);
  RecordProperty("features", errors.count);
  RecordProperty("median_degrees", std::to_string(errors.median));
  RecordProperty("percentile_degrees", std::to_string(errors.percentile));
  RecordProperty("median_color_difference", std::to_string(difference));
  std::printf("frame %d: %d features, median %.3f, 90th percentile %.3f degrees, colour %.2f\n",
              GetParam(), errors.count, errors.median, errors.percentile, difference);
  EXPECT_GT(errors.count, 1000);
  EXPECT_LT(errors.median, 0.1);
  EXPECT_LT(errors.percentile, 0.2);
  EXPECT_LT(difference, 4.0);
}

INSTANTIATE_TEST_SUITE_P(Frames, EacOfGoProMax, testing::Range(1, 5));

}  // namespace
}  // namespace orb360
