#include "tests/apps/orb360/textured_room.h"

#include <cmath>
#include <cstdint>
#include <cstdio>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

const Eigen::Vector3d kHalfSize(5.0, 3.0, 2.0);  // metres

/// 0 to 1, the same for the same cell of a layer of patches.
double Noise(int layer, double a, double b) {
  const auto cell = [](double x) { return static_cast<std::uint32_t>(std::lround(std::floor(x))); };
  std::uint32_t hash = static_cast<std::uint32_t>(layer) * 0x9e3779b9u;
  hash = (hash ^ cell(a)) * 0x85ebca6bu;
  hash = (hash ^ (hash >> 13) ^ cell(b)) * 0xc2b2ae35u;
  hash = (hash ^ (hash >> 16)) * 0x27d4eb2fu;
  return (hash >> 8) / 16777216.0;
}

/// Where a ray from inside meets a wall, the brightness of that place.
double Brightness(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double range = INFINITY;
  int wall = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double side = std::copysign(kHalfSize[axis], direction[axis]);
    const double to_wall = (side - origin[axis]) / direction[axis];
    if (to_wall < range) {
      range = to_wall;
      wall = 2 * axis + (side > 0 ? 1 : 0);
    }
  }
  const Eigen::Vector3d point = origin + range * direction;
  const double a = point[(wall / 2 + 1) % 3];
  const double b = point[(wall / 2 + 2) % 3];
  // Patches of 12 cm on patches of 40 cm.
  return 30.0 + 110.0 * Noise(wall, a / 0.4, b / 0.4) + 110.0 * Noise(wall + 6, a / 0.12, b / 0.12);
}

}  // namespace

Rigid3 TexturedRoom::WorldFromCamera(int i) {
  const double way = 0.04 * i;
  return {ExpSo3(Eigen::Vector3d::UnitZ() * 0.15 * way),
          Eigen::Vector3d(2.0 - way, 0.3 * std::sin(1.5 * way), 0.1 * std::sin(2.0 * way))};
}

std::vector<StampedPose> TexturedRoom::Trajectory(int count, double frame_rate) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < count; ++i) poses.push_back({i / frame_rate, WorldFromCamera(i)});
  return poses;
}

cv::Mat TexturedRoom::Draw(int i) const {
  const EquirectangularCamera camera(size_.width, size_.height);
  const Rigid3 world_from_camera = WorldFromCamera(i);
  const Eigen::Matrix3d rotation = world_from_camera.rotation.toRotationMatrix();
  cv::Mat image(size_, CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const Eigen::Vector3d direction = rotation * camera.Bearing({u + 0.5, v + 0.5});
      image.at<uchar>(v, u) =
          cv::saturate_cast<uchar>(Brightness(world_from_camera.translation, direction));
    }
  }
  // Against the jagged edges of a single sample a pixel.
  cv::GaussianBlur(image, image, {3, 3}, 0.0);
  return image;
}

std::vector<cv::Mat> TexturedRoom::DrawAll(int count) const {
  std::vector<cv::Mat> images;
  for (int i = 0; i < count; ++i) images.push_back(Draw(i));
  return images;
}

void WriteFolder(const std::filesystem::path& folder, const std::vector<cv::Mat>& images,
                 const std::string& extension) {
  std::filesystem::create_directories(folder);
  for (size_t i = 0; i < images.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "%06zu", i);
    ASSERT_TRUE(cv::imwrite((folder / (name + extension)).string(), images[i]));
  }
}

void WriteVideo(const std::filesystem::path& path, const std::vector<cv::Mat>& images) {
  cv::VideoWriter writer(path.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                         30.0, images.front().size());
  ASSERT_TRUE(writer.isOpened()) << path;
  for (const cv::Mat& image : images) {
    cv::Mat bgr;
    cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
    writer << bgr;
  }
}

}  // namespace orb360
