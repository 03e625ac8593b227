#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "slam/io/export/export_scene.h"

namespace orb360 {

/// The id of no point in COLMAP's files.
inline constexpr uint64_t kNoColmapPoint = std::numeric_limits<uint64_t>::max();

/// An image of COLMAP: one view of one frame.
struct ColmapImage {
  uint32_t id = 0;         ///< From 1.
  uint32_t camera_id = 0;  ///< Number of its view, from 1.
  uint32_t frame_id = 0;   ///< From 1.
  Rigid3 camera_from_world;
  std::string name;
  /// A pixel with the id of its point.
  struct Point2D {
    Eigen::Vector2d pixel;
    uint64_t point_id = kNoColmapPoint;
  };
  std::vector<Point2D> points;
};

/// A point of COLMAP with the images that show it.
struct ColmapPoint {
  uint64_t id = 0;  ///< From 1.
  Eigen::Vector3d position;
  Color color{};
  double error = -1;  ///< Mean reprojection error, pixels; -1 where no image shows it.
  struct TrackElement {
    uint32_t image_id;
    uint32_t point2d;  ///< Index into ColmapImage::points.
  };
  std::vector<TrackElement> track;
};

/// What the files of a model contain. Camera `i + 1` is view `i` of the scene, and frame `f + 1` is
/// frame `f` of its model; images are ordered by frame and then by camera.
struct ColmapModel {
  std::vector<ColmapImage> images;
  std::vector<ColmapPoint> points;
};

/// Assigns every observation to all views that show it. Landmarks that no view shows are left out.
ColmapModel MakeColmapModel(const ExportScene& scene);

/// Returns the pose of a view in the rig, whose frame is that of the first view.
Rigid3 ViewFromRig(const ExportScene& scene, const View& view);

/// Returns the pose of a frame's rig.
Rigid3 RigFromWorld(const ExportScene& scene, const PosedFrame& frame);

/// COLMAP's number, name and parameters of a view's camera model.
struct ColmapCameraModel {
  int32_t id;
  const char* name;
  std::vector<double> parameters;
};
ColmapCameraModel CameraModelOf(const View& view);

void WriteColmapText(const ExportScene& scene, const ColmapModel& model,
                     const std::filesystem::path& folder);
void WriteColmapBinary(const ExportScene& scene, const ColmapModel& model,
                       const std::filesystem::path& folder);

}  // namespace orb360
