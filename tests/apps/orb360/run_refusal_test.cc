#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/atomic_file.h"
#include "tests/apps/orb360/run_fixture.h"
#include <orb360/slam/io/map_file.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(RunTest, DepthThatIsNotMadeCannotBeSaved) {
  WriteBlanks();
  EXPECT_THAT(Refusal({"--save-depth", "--weights", "none"}), HasSubstr("--save-depth"));
  EXPECT_THAT(Refusal({"--cloud-quality", "draft", "--weights", "none"}),
              HasSubstr("--cloud-quality"));
}

TEST_F(RunTest, AMapThatCannotBeWrittenIsRefusedBeforeAnyWork) {
  WriteBlanks();
  const std::string path = folder_ / "absent" / "room.map";
  EXPECT_THAT(Refusal({"--map-out", path}), AllOf(HasSubstr(path), HasSubstr("cannot be written")));
}

TEST_F(RunTest, TheFolderOfASequenceIsNotOverwritten) {
  WriteBlanks();
  std::filesystem::create_directories(folder_ / "drive" / "depth");
  WriteText(folder_ / "drive" / "sequence.yaml", "fps: 30\n");
  WriteText(folder_ / "drive" / "depth" / "000000.png", "the truth");
  const ProgramResult result = RunOrb360({"run", Input(), "--out", folder_ / "drive"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("drive: has a sequence")));
  EXPECT_EQ(ReadText(folder_ / "drive" / "depth" / "000000.png"), "the truth");
}

TEST_F(RunTest, RefusesWhatIsNoNetwork) {
  WriteRoom();
  EXPECT_THAT(Refusal({"--weights", Image(0)}), HasSubstr("is not a network of orb360"));
}

TEST_F(RunTest, ImagesOfMixedSizesAreRefused) {
  WriteBlanks();
  WriteFolder(folder_ / "small", {cv::Mat(128, 256, CV_8UC1, cv::Scalar(9))});
  std::filesystem::rename(folder_ / "small" / "000000.png", folder_ / "input" / "000002.png");
  EXPECT_THAT(Refusal(),
              AllOf(HasSubstr("000002.png"), HasSubstr("256x128"), HasSubstr("384x192")));
}

TEST_F(RunTest, PerspectiveVideoIsRefusedWithTheReason) {
  WriteVideo(folder_ / "input.avi",
             std::vector<cv::Mat>(2, cv::Mat(288, 512, CV_8UC1, cv::Scalar(99))));
  std::filesystem::rename(folder_ / "input.avi", Input());
  EXPECT_THAT(Refusal(), AllOf(HasSubstr(Input() + ": 512x288 is not a full sphere"),
                               HasSubstr("equirectangular")));
}

TEST_F(RunTest, RawFisheyeRecordingsNeedACalibration) {
  WriteBlanks();
  EXPECT_THAT(Refusal({"--lens", "insta360"}),
              HasSubstr("is a folder of images, and --lens describes"));
  std::filesystem::remove_all(Input());
  WriteText(Input(), "no video");
  EXPECT_THAT(Refusal({"--lens", "nokia"}),
              AllOf(HasSubstr("--lens: `nokia`"), HasSubstr("gopro-fusion")));
  EXPECT_THAT(Refusal({"--lens", "insta360"}), HasSubstr("cannot be read as a video"));
}

TEST_F(RunTest, InputThatIsNotThereOrEmptyIsRefused) {
  EXPECT_THAT(Refusal(), HasSubstr(Input() + ": no such file or folder"));
  std::filesystem::create_directory(Input());
  EXPECT_THAT(Refusal(), HasSubstr(Input() + ": contains no images"));
}

TEST_F(RunTest, AConfigurationIsRefusedByKeyAndLine) {
  WriteBlanks();
  WriteText(folder_ / "c.yaml", "features:\n  count: 1000\n  colour: 3\n");
  EXPECT_THAT(Refusal({"--config", folder_ / "c.yaml"}),
              HasSubstr("c.yaml:3: unknown key features.colour"));
  WriteText(folder_ / "c.yaml", "\nfeatures:\n  count: plenty\n");
  EXPECT_THAT(Refusal({"--config", folder_ / "c.yaml"}),
              HasSubstr("c.yaml:3: features.count must be a whole number"));
  EXPECT_THAT(Refusal({"--config", folder_ / "absent.yaml"}), HasSubstr("absent.yaml"));
}

TEST_F(RunTest, ACameraHeightOfTheInputThatIsOutOfRangeIsRefused) {
  const std::filesystem::path input = folder_ / "input";
  WriteFolder(input / "rgb", std::vector<cv::Mat>(3, cv::Mat(kSize, CV_8UC1, cv::Scalar(99))));
  WriteText(input / "sequence.yaml",
            "camera: {model: equirectangular}\nfps: 20\ncamera_height: 150\n");
  EXPECT_THAT(Refusal(), HasSubstr(Input() + ": camera.height_m must be 0 to 100, not 150"));
}

TEST_F(RunTest, AMaskThatIsNotThereIsRefused) {
  WriteBlanks();
  EXPECT_THAT(Refusal({"--mask", folder_ / "absent.png"}), HasSubstr("absent.png: no such mask"));
}

TEST_F(RunTest, AMapThatDoesNotFitIsRefused) {
  WriteBlanks();
  const std::string path = folder_ / "room.map";
  WriteFileAtomically(path, "an image");
  EXPECT_THAT(Refusal({"--map-in", path}), HasSubstr("is not a map of orb360"));
  Map map;
  map.AddKeyframe(0, 0.0, {}, std::make_shared<Features>());
  WriteMap(path, {512, {}, {}, map});
  EXPECT_THAT(Refusal({"--map-in", path}),
              AllOf(HasSubstr("512 pixels wide"), HasSubstr("--resize 512x256")));
}

TEST_F(RunTest, ResizeGivesASmallerSphereAndOnlyASphere) {
  WriteRoom();
  EXPECT_THAT(Refusal({"--resize", "300x300"}), HasSubstr("`300x300` is not WIDTHxHEIGHT"));
  EXPECT_THAT(Refusal({"--resize", "300"}), HasSubstr("`300` is not WIDTHxHEIGHT"));
  EXPECT_EQ(Run({"--resize", "320x160"}).status, 0);
  EXPECT_EQ(Summary()["tracked"], kFrames);
}

}  // namespace
}  // namespace orb360
