#include "slam/features/orb_extractor.h"

#include <cstring>
#include <map>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "slam/features/matching.h"
#include "slam/geometry/bearing.h"
#include "tests/dispatch_targets.h"
#include "tests/slam/features/sphere_texture.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const EquirectangularCamera kCamera(1024, 512);

cv::Mat Image(const Eigen::Quaterniond& orientation) {
  static const SphereTexture kTexture(5, 2.0 * kCamera.AngleOfPixels(1.0));
  return kTexture.Render(kCamera, orientation, 2.0);
}

OrbOptions Thousand() {
  OrbOptions options;
  options.num_features = 1000;
  return options;
}

cv::Mat Roll(const cv::Mat& image, int shift) {
  cv::Mat rolled;
  cv::hconcat(image.colRange(image.cols - shift, image.cols), image.colRange(0, image.cols - shift),
              rolled);
  return rolled;
}

TEST(OrbExtractor, RollingByA32ndOfATurnGivesExactlyTheSameFeaturesShifted) {
  const cv::Mat image = Image(Eigen::Quaterniond::Identity());
  OrbExtractor extractor(Thousand());
  const Features features = extractor.Extract(image);
  ASSERT_GT(features.size(), 900);
  for (const int k : {1, 7, 16, 31}) {
    const int shift = k * image.cols / 32;
    const Features rolled = extractor.Extract(Roll(image, shift));
    ASSERT_EQ(rolled.size(), features.size());
    std::map<std::tuple<int, float, float>, int> by_place;
    for (int i = 0; i < rolled.size(); ++i) {
      const Keypoint& p = rolled.keypoints[i];
      by_place[{p.level, p.pixel.y(), p.pixel.x()}] = i;
    }
    int same = 0;
    for (int i = 0; i < features.size(); ++i) {
      const Keypoint& p = features.keypoints[i];
      // Positions are single precision: adding the shift rounds, nothing else may differ.
      const double u = kCamera.WrapU(p.pixel.x() + shift);
      for (auto it = by_place.lower_bound({p.level, p.pixel.y(), u - 1e-3});
           it != by_place.end() && std::get<0>(it->first) == p.level &&
           std::get<1>(it->first) == p.pixel.y() && std::get<2>(it->first) < u + 1e-3;
           ++it) {
        const Keypoint& q = rolled.keypoints[it->second];
        same += q.angle == p.angle && q.score == p.score &&
                rolled.descriptors[it->second] == features.descriptors[i];
      }
    }
    EXPECT_EQ(same, features.size()) << "k " << k;
  }
}

TEST(OrbExtractorSlow, AnyOtherRollFindsNineOfTenWithinATenthOfADegree) {
  // At 2048 pixels, where a tenth of a degree is half a pixel of level 0 and a sixth of one of the
  // coarsest level.
  const EquirectangularCamera camera(2048, 1024);
  const cv::Mat image = SphereTexture(5, 2.0 * camera.AngleOfPixels(1.0))
                            .Render(camera, Eigen::Quaterniond::Identity(), 2.0);
  OrbExtractor extractor{OrbOptions()};
  const Features features = extractor.Extract(image);
  int found = 0;
  int total = 0;
  for (const int shift : {333, 905}) {  // no multiples of a 32nd
    const Features rolled = extractor.Extract(Roll(image, shift));
    const Eigen::Quaterniond turn = ExpSo3({0, 0, -camera.AngleOfPixels(shift)});
    total += features.size();
    std::vector<int> near;
    for (const Eigen::Vector3d& bearing : features.bearings) {
      const Eigen::Vector3d expected = turn * bearing;
      near.clear();
      rolled.grid.Query(expected, 0.1 * kDegree, &near);
      found += std::any_of(near.begin(), near.end(), [&](int i) {
        return AngleBetween(rolled.bearings[i], expected) < 0.1 * kDegree;
      });
    }
  }
  std::cout << "within a tenth of a degree: " << found / static_cast<double>(total) << '\n';
  EXPECT_GT(found, 0.9 * total);
}

// Fraction of the features of the upright image whose mutually nearest descriptor in the other
// image lies within a degree of where it belongs.
double FractionFoundAgain(const std::vector<Eigen::Vector3d>& bearings1,
                          const std::vector<Descriptor>& descriptors1,
                          const std::vector<Eigen::Vector3d>& bearings2,
                          const std::vector<Descriptor>& descriptors2,
                          const Eigen::Quaterniond& camera2_from_camera1) {
  MatchOptions any;
  any.max_distance = 256;
  any.ratio = 2.0;
  int found = 0;
  for (const Match& match : MatchMutually(descriptors1, descriptors2, any)) {
    found += AngleBetween(camera2_from_camera1 * bearings1[match.first], bearings2[match.second]) <
             kDegree;
  }
  return found / static_cast<double>(bearings1.size());
}

void ExtractFlat(const cv::Mat& image, int count, std::vector<Eigen::Vector3d>* bearings,
                 std::vector<Descriptor>* descriptors) {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat rows;
  cv::ORB::create(count)->detectAndCompute(image, {}, keypoints, rows);
  for (size_t i = 0; i < keypoints.size(); ++i) {
    bearings->push_back(kCamera.Bearing({keypoints[i].pt.x + 0.5, keypoints[i].pt.y + 0.5}));
    Descriptor descriptor;
    std::memcpy(descriptor.data(), rows.ptr(static_cast<int>(i)), 32);
    descriptors->push_back(descriptor);
  }
}

class Repeatability : public testing::TestWithParam<Eigen::Vector3d> {};

TEST_P(Repeatability, OutdoesFlatOrbByHalfAndFindsHalfOfTheFeaturesAgain) {
  const Eigen::Quaterniond turn = ExpSo3(GetParam());
  const cv::Mat upright = Image(Eigen::Quaterniond::Identity());
  const cv::Mat turned = Image(turn);
  OrbExtractor extractor(Thousand());
  const Features a = extractor.Extract(upright);
  const Features b = extractor.Extract(turned);
  const double ours =
      FractionFoundAgain(a.bearings, a.descriptors, b.bearings, b.descriptors, turn.conjugate());
  std::vector<Eigen::Vector3d> flat_bearings[2];
  std::vector<Descriptor> flat_descriptors[2];
  ExtractFlat(upright, a.size(), &flat_bearings[0], &flat_descriptors[0]);
  ExtractFlat(turned, b.size(), &flat_bearings[1], &flat_descriptors[1]);
  const double flat = FractionFoundAgain(flat_bearings[0], flat_descriptors[0], flat_bearings[1],
                                         flat_descriptors[1], turn.conjugate());
  RecordProperty("found_again_percent", static_cast<int>(100 * ours));
  RecordProperty("flat_orb_percent", static_cast<int>(100 * flat));
  std::cout << "found again: " << ours << ", flat ORB: " << flat << '\n';
  EXPECT_GT(ours, 0.5);
  EXPECT_GT(ours, 1.5 * flat);
}

INSTANTIATE_TEST_SUITE_P(Turns, Repeatability,
                         testing::Values(Eigen::Vector3d(0, 45 * kDegree, 0),
                                         Eigen::Vector3d(45 * kDegree, 0, 0),
                                         Eigen::Vector3d(0, 90 * kDegree, 0),
                                         Eigen::Vector3d(0.9, -1.1, 0.7)));

TEST(OrbExtractor, DistributesFeaturesBySolidAngle) {
  OrbExtractor extractor(Thousand());
  const Features features = extractor.Extract(Image(Eigen::Quaterniond::Identity()));
  EXPECT_NEAR(features.size(), 1000, 60);
  int polar = 0;  // beyond 60 degrees of latitude: 13.4 % of the sphere
  for (const Eigen::Vector3d& bearing : features.bearings) polar += std::abs(bearing.z()) > 0.866;
  EXPECT_NEAR(polar, 0.134 * features.size(), 0.04 * features.size());
}

TEST(OrbExtractor, LeavesOutWhatTheMaskHides) {
  OrbExtractor extractor(Thousand());
  cv::Mat mask(512, 1024, CV_8U, cv::Scalar(255));
  mask(cv::Rect(200, 250, 400, 262)).setTo(0);
  const Features features = extractor.Extract(Image(Eigen::Quaterniond::Identity()), mask);
  EXPECT_GT(features.size(), 900);  // taken from elsewhere
  for (const Keypoint& p : features.keypoints) {
    // A corner's pixel on its level is hidden or not; its position may be half a pixel beside.
    const float reach = 4.0f;
    EXPECT_FALSE(p.pixel.x() > 200 + reach && p.pixel.x() < 600 - reach &&
                 p.pixel.y() > 250 + reach)
        << p.pixel.transpose();
  }
}

TEST(OrbExtractor, APyramidThatWasTakenStaysAsItIs) {
  const cv::Mat image = Image(Eigen::Quaterniond::Identity());
  OrbExtractor extractor(Thousand());
  const Features features = extractor.Extract(image);
  const SpherePyramid taken = extractor.TakePyramid();
  EXPECT_TRUE(extractor.TakePyramid().empty());
  const Features other = extractor.Extract(Roll(image, 300));
  const Features again = extractor.Extract(image);
  EXPECT_EQ(again.descriptors, features.descriptors);
  SpherePyramid fresh;
  BuildSpherePyramid(image, static_cast<int>(taken.size()), &fresh);
  ASSERT_EQ(fresh.size(), taken.size());
  for (size_t l = 0; l < taken.size(); ++l) {
    EXPECT_EQ(cv::norm(taken[l].padded, fresh[l].padded, cv::NORM_INF), 0) << l;
  }
}

TEST(OrbExtractor, DoesNotDependOnTheNumberOfThreads) {
  const cv::Mat image = Image(Eigen::Quaterniond::Identity());
  OrbExtractor extractor(Thousand());
  const Features one = extractor.Extract(image);
  for (const int threads : {2, 3}) {
    const Features more = extractor.Extract(image, {}, threads);
    ASSERT_EQ(more.size(), one.size());
    EXPECT_EQ(more.descriptors, one.descriptors);
    for (int i = 0; i < one.size(); ++i) {
      ASSERT_EQ(more.keypoints[i].pixel, one.keypoints[i].pixel);
      ASSERT_EQ(more.keypoints[i].angle, one.keypoints[i].angle);
    }
  }
}

TEST(OrbExtractor, FindsTheSameFeaturesOnEveryInstructionSet) {
  const cv::Mat image = Image(Eigen::Quaterniond::Identity());
  OrbExtractor extractor(Thousand());
  const Features reference = extractor.Extract(image);
  ForEachDispatchTarget([&] {
    const Features features = extractor.Extract(image);
    ASSERT_EQ(features.size(), reference.size());
    int differing_bits = 0;
    for (int i = 0; i < features.size(); ++i) {
      ASSERT_EQ(features.keypoints[i].pixel, reference.keypoints[i].pixel);
      for (int w = 0; w < 4; ++w) {
        differing_bits +=
            __builtin_popcountll(features.descriptors[i][w] ^ reference.descriptors[i][w]);
      }
    }
    // With and without fused multiplication a sample may fall on the other side of a pixel's edge.
    EXPECT_LT(differing_bits, 0.001 * 256 * features.size());
  });
}

TEST(OrbExtractor, FindsNothingOnAnEmptyImage) {
  OrbExtractor extractor(Thousand());
  EXPECT_EQ(extractor.Extract(cv::Mat(512, 1024, CV_8U, cv::Scalar(90))).size(), 0);
}

TEST(OrbExtractor, TakesImagesOfAnySize) {
  cv::Mat noise(500, 1001, CV_8U);
  cv::randu(noise, 0, 256);
  for (const cv::Size size : {cv::Size(1001, 500), cv::Size(640, 322), cv::Size(200, 100)}) {
    OrbExtractor extractor(Thousand());
    const Features features = extractor.Extract(noise(cv::Rect({0, 0}, size)).clone());
    EXPECT_GT(features.size(), 100) << size;
    for (const Eigen::Vector3d& bearing : features.bearings) EXPECT_NEAR(bearing.norm(), 1, 1e-9);
  }
}

TEST(OrbExtractor, RefusesAnotherTypeOfImage) {
  OrbExtractor extractor(Thousand());
  EXPECT_THROW(extractor.Extract(cv::Mat(512, 1024, CV_8UC3)), ContractError);
}

}  // namespace
}  // namespace orb360
