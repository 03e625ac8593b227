#include "slam/io/export/nerfstudio.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/slam/io/synthetic_model.h"
#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

/// Frames 0 to 5; frame 3 has depth: 4 m in each direction, nothing in the left half of the image,
/// and 80 m straight above.
struct DepthScene {
  TempFolder folder;
  DepthMapStore store{folder / "store"};
  ExportScene scene;

  explicit DepthScene(bool is_cube) {
    scene.model = MakeSyntheticModel({6, 3, 256});
    scene.views = is_cube ? CubeViews(256, 96 * std::numbers::pi / 180) : PanoramaView(256, 128);
    scene.frames_with_depth = {3};
    DenseDepth depth;
    depth.range = cv::Mat(64, 128, CV_32FC1, cv::Scalar(4.0));
    depth.range.rowRange(0, 8).setTo(80.0);
    depth.range.colRange(0, 64).setTo(0);
    depth.confidence = cv::Mat(64, 128, CV_32FC1, cv::Scalar(0.9));
    depth.color = cv::Mat(64, 128, CV_8UC3, cv::Scalar::all(90));
    store.Put(3, depth);
    WriteViewDepth(scene, store, folder / "out");
  }

  cv::Mat Read(const std::string& name) const {
    return cv::imread(folder / "out" / "depth" / name, cv::IMREAD_UNCHANGED);
  }
};

// Ranges are stored with an error of 0.05 %, which is 2 mm of 4 m.
TEST(Nerfstudio, TheDepthOfAPanoramaIsTheDistanceAlongTheRayInMillimetres) {
  const DepthScene depth(false);
  const cv::Mat image = depth.Read("000003.png");
  ASSERT_EQ(image.size(), cv::Size(256, 128));
  ASSERT_EQ(image.type(), CV_16UC1);
  EXPECT_NEAR(image.at<uint16_t>(64, 200), 4000, 3);
  EXPECT_NEAR(image.at<uint16_t>(120, 200), 4000, 3);
  EXPECT_EQ(image.at<uint16_t>(64, 60), 0) << "is not known";
  EXPECT_EQ(image.at<uint16_t>(2, 200), 0) << "is farther than 16 bits reach";
}

TEST(Nerfstudio, TheDepthOfAPinholeViewIsTheZCoordinate) {
  const DepthScene depth(true);
  const View& front = depth.scene.views.front();
  const cv::Mat image = depth.Read("front/000003.png");
  ASSERT_EQ(image.size(), cv::Size(front.width, front.height));
  for (const int column : {front.width / 2, front.width - 1}) {
    const double x = (column + 0.5 - 0.5 * front.width) / front.focal;
    const double y = 0.5 / front.focal;  // the row below the middle
    const double z = 4000 / std::sqrt(1 + x * x + y * y);
    EXPECT_NEAR(image.at<uint16_t>(front.height / 2, column), z, 3) << column;
  }
  EXPECT_EQ(image.at<uint16_t>(front.height / 2, 3), 0);
}

// nerfstudio refuses a file in which only some frames have a depth map.
TEST(Nerfstudio, AllFramesNameADepthMapWhichIsThereOrNoneDoes) {
  const DepthScene depth(true);
  ExportNerfstudio(depth.scene, depth.folder / "out");
  const nlohmann::json json =
      nlohmann::json::parse(ReadText(depth.folder / "out" / "transforms.json"));
  int named = 0;
  for (const nlohmann::json& frame : json["frames"]) {
    EXPECT_FALSE(frame.contains("mask_path"));
    const bool is_frame_3 = frame["file_path"].get<std::string>().ends_with("000003.jpg");
    ASSERT_TRUE(frame.contains("depth_file_path"));
    const std::string name = frame["depth_file_path"];
    const cv::Mat map = cv::imread(depth.folder / "out" / name, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(map.type(), CV_16UC1) << name;
    EXPECT_EQ(map.size(), cv::Size(json["w"], json["h"]));
    EXPECT_EQ(name == "depth/none.png", !is_frame_3);
    if (!is_frame_3) {
      EXPECT_EQ(cv::countNonZero(map), 0);
    }
    named += is_frame_3 ? 1 : 0;
  }
  EXPECT_EQ(named, 6);

  DepthScene without(false);
  without.scene.frames_with_depth.clear();
  ExportNerfstudio(without.scene, without.folder / "out");
  EXPECT_THAT(ReadText(without.folder / "out" / "transforms.json"),
              testing::Not(testing::HasSubstr("depth_file_path")));
}

}  // namespace
}  // namespace orb360
