#include "slam/io/export/nerfstudio.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "slam/io/atomic_file.h"
#include "slam/io/export/make_folder.h"
#include "slam/io/export/view_resampler.h"
#include "slam/io/image_file.h"
#include "slam/io/json_text.h"
#include "slam/io/ply.h"

namespace orb360 {
namespace {

constexpr const char* kPointsName = "sparse_pc.ply";
// nerfstudio wants a depth map for every image or for none. This one knows nothing.
constexpr const char* kNoDepthName = "none.png";

/// Returns the matrix of a view's pose with OpenGL's camera axes.
nlohmann::json TransformOf(const PosedFrame& frame, const View& view) {
  const Eigen::Quaterniond optical_from_view = view.view_from_optical.conjugate();
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() =
      (frame.world_from_optical.rotation * optical_from_view).toRotationMatrix() *
      Eigen::Vector3d(1, -1, -1).asDiagonal();
  pose.topRightCorner<3, 1>() = frame.world_from_optical.translation;
  nlohmann::json rows = nlohmann::json::array();
  for (int row = 0; row < 4; ++row) {
    rows.push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
  }
  return rows;
}

/// All views have the same size and focal length.
nlohmann::json CameraOf(const View& view) {
  nlohmann::json camera = {{"camera_model", view.is_panorama() ? "EQUIRECTANGULAR" : "PINHOLE"},
                           {"w", view.width},
                           {"h", view.height},
                           {"cx", 0.5 * view.width},
                           {"cy", 0.5 * view.height},
                           {"fl_x", view.focal},
                           {"fl_y", view.focal}};
  if (view.is_panorama()) {
    // nerfstudio's sphere: (u - cx) / fl_x is the longitude over pi, (v - cy) / fl_y the latitude.
    camera["fl_x"] = 0.5 * view.width;
    camera["fl_y"] = view.height;
  }
  return camera;
}

void WritePoints(const ExportScene& scene, const std::filesystem::path& folder) {
  std::vector<ColoredPoint> points;
  points.reserve(scene.points().size());
  for (const ColoredLandmark& point : scene.points()) {
    points.push_back({point.position.cast<float>(), point.color});
  }
  WritePly(folder / kPointsName, points);
}

/// Turns ranges of a view (CV_32FC1, metres) into what is stored. `view` tells the angle of each
/// ray.
cv::Mat EncodeDepth(const cv::Mat& range, const View& view) {
  constexpr double kUnitsPerMetre = 1000.0;
  cv::Mat encoded(range.size(), CV_16UC1);
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      double depth = range.at<float>(row, column);
      if (!view.is_panorama()) {
        const Eigen::Vector3d ray(column + 0.5 - 0.5 * view.width, row + 0.5 - 0.5 * view.height,
                                  view.focal);
        depth *= view.focal / ray.norm();
      }
      const double units = std::round(depth * kUnitsPerMetre);
      encoded.at<uint16_t>(row, column) =
          units > 0 && units <= 65535 ? static_cast<uint16_t>(units) : 0;
    }
  }
  return encoded;
}

}  // namespace

void ExportNerfstudio(const ExportScene& scene, const std::filesystem::path& folder) {
  nlohmann::json json = CameraOf(scene.views.front());
  json["applied_transform"] = {{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}};
  json["ply_file_path"] = kPointsName;
  nlohmann::json frames = nlohmann::json::array();
  for (const PosedFrame& frame : scene.model.frames) {
    const bool has_depth = std::ranges::binary_search(scene.frames_with_depth, frame.index);
    for (const View& view : scene.views) {
      const std::string name = ImageName(scene, frame, view);
      nlohmann::json image = {{"file_path", std::string(kImagesFolder) + "/" + name},
                              {"transform_matrix", TransformOf(frame, view)}};
      if (scene.has_masks) {
        image["mask_path"] = std::string(kMasksFolder) + "/" + MaskName(name);
      }
      if (!scene.frames_with_depth.empty()) {
        image["depth_file_path"] =
            std::string(kDepthFolder) + "/" + (has_depth ? DepthName(frame, view) : kNoDepthName);
      }
      frames.push_back(std::move(image));
    }
  }
  json["frames"] = std::move(frames);
  WritePoints(scene, folder);
  WriteFileAtomically(folder / "transforms.json", ToJsonText(json, 1) + "\n");
}

void WriteViewDepth(const ExportScene& scene, const DepthMapStore& store,
                    const std::filesystem::path& folder) {
  const std::filesystem::path depth = folder / kDepthFolder;
  const ViewResampler resampler({scene.model.width, scene.model.height}, scene.views);
  for (const View& view : scene.views) MakeFolder(depth / view.name);
  const View& first = scene.views.front();
  WriteImage(depth / kNoDepthName, cv::Mat::zeros(first.height, first.width, CV_16UC1));
  for (const PosedFrame& frame : scene.model.frames) {
    if (!std::ranges::binary_search(scene.frames_with_depth, frame.index)) continue;
    const cv::Mat range = store.Get(frame.index).range;
    for (size_t v = 0; v < scene.views.size(); ++v) {
      const View& view = scene.views[v];
      WriteImage(depth / DepthName(frame, view),
                 EncodeDepth(resampler.ResampleNearest(range, v), view));
    }
  }
}

}  // namespace orb360
