#include "slam/io/video/spherical_metadata.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/slam/io/video/video_fixture.h"
#include <orb360/slam/io/sequence.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using SphericalVideo = VideoSourceTest;

AVSphericalMapping Equirectangular() {
  AVSphericalMapping mapping{};
  mapping.projection = AV_SPHERICAL_EQUIRECTANGULAR;
  return mapping;
}

AVStereo3D Stereo(AVStereo3DType type, int flags = 0) {
  AVStereo3D stereo{};
  stereo.type = type;
  stereo.flags = flags;
  return stereo;
}

TEST_F(SphericalVideo, TheLeftEyeOfStereoIsUsed) {
  struct Layout {
    cv::Size size;
    AVStereo3DType type;
    int flags;
    int quarter;  // one that only the left eye shows
  };
  for (const Layout& layout :
       {Layout{{128, 128}, AV_STEREO3D_TOPBOTTOM, 0, 0},
        Layout{{128, 128}, AV_STEREO3D_TOPBOTTOM, AV_STEREO3D_FLAG_INVERT, 2},
        Layout{{256, 64}, AV_STEREO3D_SIDEBYSIDE, 0, 0},
        Layout{{256, 64}, AV_STEREO3D_SIDEBYSIDE, AV_STEREO3D_FLAG_INVERT, 1}}) {
    TrackSpec spec = Still(Quarters(layout.size));
    spec.stereo = Stereo(layout.type, layout.flags);
    // MP4's box has no place for the flag.
    VideoSource source(Write(spec, "video.mkv"));
    EXPECT_EQ(source.info().image_size, cv::Size(128, 64));
    const cv::Mat image = source.Read()->image;
    ASSERT_EQ(image.size(), cv::Size(128, 64));
    EXPECT_EQ(QuarterOf(image.at<cv::Vec3b>(8, 8)), layout.quarter);
    EXPECT_THAT(source.TakeWarnings(), ElementsAre(HasSubstr("only the left eye")));
  }
}

TEST_F(SphericalVideo, EyesThatWereSqueezedAreStretched) {
  TrackSpec spec = Still(Quarters({128, 64}));
  spec.spherical = Equirectangular();
  spec.stereo = Stereo(AV_STEREO3D_SIDEBYSIDE);
  EXPECT_EQ(VideoSource(Write(spec)).info().image_size, cv::Size(128, 64));
  spec.stereo = Stereo(AV_STEREO3D_TOPBOTTOM);
  EXPECT_EQ(VideoSource(Write(spec)).info().image_size, cv::Size(128, 64));
}

TEST_F(SphericalVideo, ACroppedPanoramaLiesWhereItsMetadataPlaceIt) {
  for (const bool is_xml : {false, true}) {
    // The middle half of the width, and the lower three quarters of the height.
    TrackSpec spec = Still(Quarters({64, 48}));
    if (!is_xml) {
      spec.spherical = Equirectangular();
      spec.spherical->projection = AV_SPHERICAL_EQUIRECTANGULAR_TILE;
      spec.spherical->bound_left = spec.spherical->bound_right = spec.spherical->bound_top = 1u
                                                                                             << 30;
    }
    const std::string path = Write(spec);
    if (is_xml) {
      InsertGSphericalXml(path,
                          "<rdf><GSpherical:Spherical>true</GSpherical:Spherical>"
                          "<GSpherical:ProjectionType>equirectangular</GSpherical:ProjectionType>"
                          "<GSpherical:CroppedAreaImageWidthPixels>640"
                          "</GSpherical:CroppedAreaImageWidthPixels>"
                          "<GSpherical:CroppedAreaImageHeightPixels>480"
                          "</GSpherical:CroppedAreaImageHeightPixels>"
                          "<GSpherical:FullPanoWidthPixels>1280</GSpherical:FullPanoWidthPixels>"
                          "<GSpherical:FullPanoHeightPixels>640</GSpherical:FullPanoHeightPixels>"
                          "<GSpherical:CroppedAreaLeftPixels>320</GSpherical:CroppedAreaLeftPixels>"
                          "<GSpherical:CroppedAreaTopPixels>160</GSpherical:CroppedAreaTopPixels>"
                          "</rdf>");
    }
    const auto sequence = OpenSequence(path, {});
    ASSERT_EQ(sequence->image_size(), cv::Size(128, 64)) << is_xml;
    cv::Mat expected = cv::Mat::zeros(64, 128, CV_8U);
    expected({32, 16, 64, 48}) = 255;
    EXPECT_EQ(cv::norm(sequence->coverage(), expected, cv::NORM_INF), 0.0);
    const cv::Mat image = sequence->Next()->image;
    EXPECT_EQ(QuarterOf(image.at<cv::Vec3b>(20, 36)), 0);
    EXPECT_EQ(QuarterOf(image.at<cv::Vec3b>(60, 90)), 3);
    EXPECT_EQ(image.at<cv::Vec3b>(8, 64), cv::Vec3b(0, 0, 0));
    EXPECT_EQ(image.at<cv::Vec3b>(40, 10), cv::Vec3b(0, 0, 0));
  }
}

/// The column and the row of the brightest pixel.
cv::Point Brightest(const cv::Mat& image) {
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::GaussianBlur(gray, gray, {7, 7}, 0);
  cv::Point at;
  cv::minMaxLoc(gray, nullptr, nullptr, nullptr, &at);
  return at;
}

// Google's RFC: yaw moves what is in front to the right, pitch upwards, roll tilts to the right.
TEST_F(SphericalVideo, TheSphereIsTurnedByItsPose) {
  const auto shown = [&](cv::Point spot, double yaw, double pitch, double roll) {
    cv::Mat image(128, 256, CV_8UC3, cv::Scalar::all(30));
    cv::circle(image, spot, 5, cv::Scalar::all(255), -1);
    TrackSpec spec = Still(image);
    spec.spherical = Equirectangular();
    spec.spherical->yaw = static_cast<int>(yaw * 65536);
    spec.spherical->pitch = static_cast<int>(pitch * 65536);
    spec.spherical->roll = static_cast<int>(roll * 65536);
    return Brightest(VideoSource(Write(spec)).Read()->image);
  };
  const cv::Point front(128, 64);
  const auto expect_at = [](cv::Point at, int x, int y) {
    EXPECT_NEAR(at.x, x, 2);
    EXPECT_NEAR(at.y, y, 2);
  };
  expect_at(shown(front, 0, 0, 0), 128, 64);
  expect_at(shown(front, 45, 0, 0), 128 + 32, 64);
  expect_at(shown(front, 0, 45, 0), 128, 64 - 32);
  // What is 45 degrees above the front comes to lie 45 degrees to the right of it.
  expect_at(shown({128, 32}, 0, 0, 90), 128 + 32, 64);
  // Roll, then pitch, then yaw: the same spot is right of the front, which pitch keeps at its
  // height of 45 degrees' circle and yaw moves by another 45 degrees.
  expect_at(shown({128, 32}, 45, 0, 90), 128 + 64, 64);
}

TEST_F(SphericalVideo, TheInitialViewOfTheOlderXmlDoesNotTurnTheSphere) {
  const std::string path = Write(Still(Quarters({128, 64})));
  InsertGSphericalXml(
      path,
      "<rdf><GSpherical:Spherical>true</GSpherical:Spherical>"
      "<GSpherical:Stitched>true</GSpherical:Stitched>"
      "<GSpherical:StitchingSoftware>a test</GSpherical:StitchingSoftware>"
      "<GSpherical:ProjectionType>equirectangular</GSpherical:ProjectionType>"
      "<GSpherical:InitialViewHeadingDegrees>90</GSpherical:InitialViewHeadingDegrees></rdf>");
  EXPECT_EQ(QuarterOf(VideoSource(path).Read()->image.at<cv::Vec3b>(16, 8)), 0);
}

TEST_F(SphericalVideo, RefusesMetadataThatContradictTheImages) {
  TrackSpec spec = Still(Quarters({192, 108}));
  spec.spherical = Equirectangular();
  EXPECT_THAT(Refusal(spec), AllOf(HasSubstr("video.mp4"), HasSubstr("192x108"),
                                   HasSubstr("not twice as wide as high")));
  spec = Still(Quarters({128, 64}));
  spec.stereo = Stereo(AV_STEREO3D_TOPBOTTOM);
  EXPECT_THAT(Refusal(spec), AllOf(HasSubstr("image of one eye"), HasSubstr("128x32")));
  spec.stereo.reset();
  spec.spherical = Equirectangular();
  spec.spherical->projection = AV_SPHERICAL_EQUIRECTANGULAR_TILE;
  spec.spherical->bound_left = 1u << 31;
  EXPECT_THAT(Refusal(spec), HasSubstr("256x64"));
  spec.spherical->bound_left = spec.spherical->bound_right = 0x7fffffff;
  EXPECT_THAT(Refusal(spec), HasSubstr("nine tenths"));
}

TEST_F(SphericalVideo, RefusesOtherProjections) {
  TrackSpec spec = Still(Quarters({192, 128}));
  spec.spherical = Equirectangular();
  spec.spherical->projection = AV_SPHERICAL_CUBEMAP;
  EXPECT_THAT(Refusal(spec), AllOf(HasSubstr("cubemap"), HasSubstr("equirectangular")));
}

}  // namespace
}  // namespace orb360
