#include "apps/town/sequence/stitch_folder.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "apps/town/image/cube.h"
#include "slam/io/dataset.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360::town {
namespace {

using ::testing::HasSubstr;

constexpr int kSize = 32;
constexpr double kHalfRoom = 3;  // metres: a cube around the camera, so z is the same everywhere

class StitchFolderTest : public testing::Test {
 protected:
  StitchFolderTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("stitch_test_" + std::to_string(getpid()))) {
    for (const std::string_view face : kCubeFaceNames) {
      std::filesystem::create_directories(Recording() / face);
      std::filesystem::create_directories(Recording() / ("depth_" + std::string(face)));
    }
    for (const char* name : {"000017", "000018"}) {
      for (int face = 0; face < kCubeFaces; ++face) WriteFace(face, name);
    }
    WriteTruth("0 1 2 3 0 0 0 1\n");
  }
  ~StitchFolderTest() override { std::filesystem::remove_all(folder_); }

  void WriteTruth(const std::string& text) const {
    std::ofstream(Recording() / "groundtruth.txt") << text;
  }
  std::filesystem::path Recording() const { return folder_ / "recording"; }
  std::filesystem::path Out() const { return folder_ / "out"; }
  std::filesystem::path Face(const std::string& prefix, int face, const std::string& name) const {
    return Recording() / (prefix + std::string(kCubeFaceNames[static_cast<size_t>(face)])) /
           (name + ".png");
  }
  /// Every face has a colour of its own; even faces have 16-bit depth, odd ones the 24-bit
  /// encoding.
  void WriteFace(int face, const std::string& name) const {
    cv::imwrite(Face("", face, name).string(),
                cv::Mat3b(kSize, kSize, cv::Vec3b(static_cast<uint8_t>(40 * face), 100, 200)));
    if (face % 2 == 0) {
      cv::imwrite(Face("depth_", face, name).string(),
                  cv::Mat1w(kSize, kSize, static_cast<uint16_t>(kHalfRoom * 256)));
    } else {
      const auto number = static_cast<uint32_t>(kHalfRoom / 1000 * 16777215 + 0.5);
      cv::imwrite(Face("depth_", face, name).string(),
                  cv::Mat3b(kSize, kSize,
                            cv::Vec3b(static_cast<uint8_t>(number >> 16),
                                      static_cast<uint8_t>(number >> 8 & 255),
                                      static_cast<uint8_t>(number & 255))));
    }
  }
  int Stitch(const StitchOptions& options = {.width = 128, .fps = 10}) const {
    int frames = 0;
    StitchFolder(Recording(), Out(), options, [&](int done, int) { frames = done; });
    return frames;
  }
  std::string Problem() const {
    try {
      Stitch();
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

TEST_F(StitchFolderTest, MakesASequenceThatCanBeRead) {
  EXPECT_EQ(Stitch(), 2);
  const Dataset dataset = OpenDataset(Out());
  EXPECT_EQ(dataset.frame_rate, 10);
  EXPECT_TRUE(std::filesystem::exists(dataset.groundtruth()));
  const cv::Mat3b colour = cv::imread((dataset.images() / "000001.jpg").string());
  ASSERT_EQ(colour.size(), cv::Size(128, 64));
  EXPECT_NEAR(colour(32, 64)[0], 40 * kFront, 3);
  EXPECT_NEAR(colour(32, 96)[0], 40 * kRight, 3);
  EXPECT_NEAR(colour(1, 64)[0], 40 * kUp, 3);
  const cv::Mat1f range = ReadDepthImage(dataset.depth() / "000000.png");
  const EquirectangularCamera camera(128, 64);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 128; ++column) {
      const double distance =
          kHalfRoom / camera.Bearing({column + 0.5, row + 0.5}).cwiseAbs().maxCoeff();
      ASSERT_NEAR(range(row, column), distance, 1.0 / 256) << row << ' ' << column;
    }
  }
}

TEST_F(StitchFolderTest, KeepsWhatIsThere) {
  Stitch();
  const auto time = std::filesystem::last_write_time(Out() / "rgb/000000.jpg");
  std::filesystem::remove(Out() / "rgb/000001.jpg");
  Stitch();
  EXPECT_EQ(std::filesystem::last_write_time(Out() / "rgb/000000.jpg"), time);
  EXPECT_TRUE(std::filesystem::exists(Out() / "rgb/000001.jpg"));
}

TEST_F(StitchFolderTest, RefusesARecordingWithAGap) {
  for (int face = 0; face < kCubeFaces; ++face) WriteFace(face, "000020");
  EXPECT_THAT(Problem(), HasSubstr("frame '000018' is followed by '000020', but those before"));
}

TEST_F(StitchFolderTest, TakesFramesInTheOrderOfTheirNumbers) {
  for (const char* folder : {"", "depth_"}) {
    for (int face = 0; face < kCubeFaces; ++face) {
      std::filesystem::rename(Face(folder, face, "000017"), Face(folder, face, "9"));
      std::filesystem::rename(Face(folder, face, "000018"), Face(folder, face, "10"));
    }
  }
  for (int face = 0; face < kCubeFaces; ++face) {
    cv::imwrite(Face("", face, "10").string(), cv::Mat3b(kSize, kSize, cv::Vec3b(0, 0, 0)));
  }
  Stitch();
  EXPECT_EQ(cv::norm(cv::imread((Out() / "rgb/000001.jpg").string()), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(cv::imread((Out() / "rgb/000000.jpg").string()), cv::NORM_INF), 0);
}

TEST_F(StitchFolderTest, NeedsDepthForSomeFramesOnly) {
  for (int face = 0; face < kCubeFaces; ++face)
    std::filesystem::remove(Face("depth_", face, "000017"));
  EXPECT_EQ(Stitch({.width = 128, .fps = 10, .camera_height = 1.5}), 2);
  EXPECT_FALSE(std::filesystem::exists(Out() / "depth/000000.png"));
  EXPECT_TRUE(std::filesystem::exists(Out() / "depth/000001.png"));
  EXPECT_EQ(OpenDataset(Out()).camera_height, 1.5);
}

TEST_F(StitchFolderTest, NumbersOfObjectsAreThoseOfTheNearestPixels) {
  for (int face = 0; face < kCubeFaces; ++face) {
    std::filesystem::create_directories(Face("objects_", face, "x").parent_path());
    cv::imwrite(Face("objects_", face, "000018").string(),
                cv::Mat1w(kSize, kSize, static_cast<uint16_t>(1000 * (face + 1))));
  }
  Stitch();
  EXPECT_FALSE(std::filesystem::exists(Out() / "objects/000000.png"));
  const cv::Mat1w objects =
      cv::imread((Out() / "objects/000001.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(objects.size(), cv::Size(128, 64));
  const EquirectangularCamera camera(128, 64);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 128; ++column) {
      const CubePoint point = MeetCube(camera.Bearing({column + 0.5, row + 0.5}));
      ASSERT_EQ(objects(row, column), 1000 * (point.face + 1)) << row << ' ' << column;
    }
  }
  cv::imwrite(Face("objects_", kUp, "000018").string(), cv::Mat3b(kSize, kSize));
  std::filesystem::remove(Out() / "objects/000001.png");
  EXPECT_THAT(Problem(), HasSubstr("000018.png: does not number objects"));
}

TEST_F(StitchFolderTest, NamesWhatIsWrong) {
  std::filesystem::remove(Face("", kBack, "000018"));
  EXPECT_THAT(Problem(), HasSubstr("back: frame '000018' is missing"));
  WriteFace(kBack, "000018");
  cv::imwrite(Face("", kUp, "000017").string(), cv::Mat3b(16, 16, cv::Vec3b(0, 0, 0)));
  EXPECT_THAT(Problem(), HasSubstr("000017.png: is 16x16, but faces are square and the others"));
  WriteFace(kUp, "000017");
  std::filesystem::resize_file(Face("", kDown, "000017"), 60);
  EXPECT_THAT(Problem(), HasSubstr("down/000017.png: is cut off"));
  WriteFace(kDown, "000017");
  std::ofstream(Face("depth_", kDown, "000017")) << "no image";
  EXPECT_THAT(Problem(), HasSubstr("000017.png: is not depth"));
  // Depth to look at: a ramp of grey.
  cv::Mat3b grey(kSize, kSize, cv::Vec3b(7, 7, 7));
  grey(3, 4) = {8, 8, 8};
  cv::imwrite(Face("depth_", kDown, "000017").string(), grey);
  EXPECT_THAT(Problem(), HasSubstr("000017.png: is not depth"));
  WriteFace(kDown, "000017");
  WriteTruth("1234.5 1 2 3 0 0 0 1\n");
  EXPECT_THAT(Problem(), HasSubstr("is of 1234.5 to 1234.5 s, but the frames of 0 to 0.1 s"));
  WriteTruth("0 1 2 3 0 0 0\n");
  EXPECT_THAT(Problem(), HasSubstr("groundtruth.txt:1"));
  std::filesystem::remove_all(Recording() / "depth_front");
  EXPECT_THAT(Problem(), HasSubstr("depth_front: no such folder"));
  std::filesystem::remove_all(Recording() / "left");
  EXPECT_THAT(Problem(), HasSubstr("left: no such folder"));
}

}  // namespace
}  // namespace orb360::town
