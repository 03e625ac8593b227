#include "slam/io/full_sphere.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using ::testing::HasSubstr;

TEST(FullSphere, AcceptsTwoToOneAndWhatEncodersMakeOfIt) {
  for (const cv::Size size :
       {cv::Size(2048, 1024), cv::Size(640, 322), cv::Size(3840, 1920), cv::Size(1920, 976),
        cv::Size(1024, 512), cv::Size(1000, 512), cv::Size(5760, 2880)}) {
    EXPECT_TRUE(IsFullSphere(size)) << ToString(size);
  }
}

TEST(FullSphere, RefusesPerspectiveFormats) {
  for (const cv::Size size :
       {cv::Size(1920, 1080), cv::Size(640, 480), cv::Size(4096, 2160), cv::Size(1998, 1080),
        cv::Size(2560, 1080), cv::Size(1080, 1920), cv::Size(0, 0), cv::Size(1024, 1024)}) {
    EXPECT_FALSE(IsFullSphere(size)) << ToString(size);
  }
}

TEST(FullSphere, TheRefusalSaysWhatToDo) {
  EXPECT_THAT(MessageOf<UserError>([] {
                RequireFullSphere("a.mp4", {1920, 1080});
              }),
              HasSubstr("a.mp4: 1920x1080 is not a full sphere"));
  EXPECT_THAT(MessageOf<UserError>([] {
                RequireFullSphere("a.mp4", {1920, 1080});
              }),
              HasSubstr("scale it to 1920x960"));
  EXPECT_THAT(MessageOf<UserError>([] {
                RequireFullSphere("a.mp4", {2880, 2880});
              }),
              HasSubstr("crop it to one eye"));
  EXPECT_NO_THROW(RequireFullSphere("a.mp4", {640, 322}));
}

}  // namespace
}  // namespace orb360
