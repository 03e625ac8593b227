#include <span>
#include <string>

#include "slam/io/chunked_file.h"
#include "slam/io/export/colmap_model.h"
#include "slam/io/export/pose_text.h"

namespace orb360 {
namespace {

void AppendPose(const Rigid3& pose, std::string* line) {
  AppendNumbers(ScalarFirst(pose.rotation), ' ', line);
  AppendNumbers(pose.translation, ' ', line);
}

void WriteCameras(const ExportScene& scene, const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.Write("# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n");
  uint64_t id = 0;
  for (const View& view : scene.views) {
    const ColmapCameraModel model = CameraModelOf(view);
    std::string line = std::to_string(++id);
    line += ' ';
    line += model.name;
    AppendInteger(static_cast<uint64_t>(view.width), ' ', &line);
    AppendInteger(static_cast<uint64_t>(view.height), ' ', &line);
    AppendNumbers(model.parameters, ' ', &line);
    file.Write(line += '\n');
  }
  file.Commit();
}

void WriteRigs(const ExportScene& scene, const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.Write(
      "# RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, REF_SENSOR_ID, SENSORS[] as (SENSOR_TYPE, "
      "SENSOR_ID, HAS_POSE, [QW, QX, QY, QZ, TX, TY, TZ])\n");
  std::string line = "1";
  AppendInteger(scene.views.size(), ' ', &line);
  line += " CAMERA 1";
  for (size_t v = 1; v < scene.views.size(); ++v) {
    line += " CAMERA";
    AppendInteger(v + 1, ' ', &line);
    line += " 1";
    AppendPose(ViewFromRig(scene, scene.views[v]), &line);
  }
  file.Write(line += '\n');
  file.Commit();
}

void WriteFrames(const ExportScene& scene, const ColmapModel& model,
                 const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.Write(
      "# FRAME_ID, RIG_ID, RIG_FROM_WORLD[QW, QX, QY, QZ, TX, TY, TZ], NUM_DATA_IDS, DATA_IDS[] as "
      "(SENSOR_TYPE, SENSOR_ID, DATA_ID)\n");
  const size_t views = scene.views.size();
  for (size_t f = 0; f < scene.model.frames.size(); ++f) {
    std::string line = std::to_string(f + 1);
    line += " 1";
    AppendPose(RigFromWorld(scene, scene.model.frames[f]), &line);
    AppendInteger(views, ' ', &line);
    for (size_t v = 0; v < views; ++v) {
      const ColmapImage& image = model.images[f * views + v];
      line += " CAMERA";
      AppendInteger(image.camera_id, ' ', &line);
      AppendInteger(image.id, ' ', &line);
    }
    file.Write(line += '\n');
  }
  file.Commit();
}

void WriteImages(const ColmapModel& model, const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.Write("# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n");
  file.Write("# POINTS2D[] as (X, Y, POINT3D_ID)\n");
  for (const ColmapImage& image : model.images) {
    std::string line = std::to_string(image.id);
    AppendPose(image.camera_from_world, &line);
    AppendInteger(image.camera_id, ' ', &line);
    line += ' ';
    line += image.name;
    file.Write(line += '\n');
    line.clear();
    for (const ColmapImage::Point2D& point : image.points) {
      AppendNumbers(std::span(point.pixel.data(), 2), ' ', &line);
      if (point.point_id == kNoColmapPoint) {
        line += " -1";
      } else {
        AppendInteger(point.point_id, ' ', &line);
      }
    }
    line += '\n';
    file.Write(std::string_view(line).substr(line.starts_with(' ') ? 1 : 0));
  }
  file.Commit();
}

void WritePoints(const ColmapModel& model, const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.Write("# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n");
  for (const ColmapPoint& point : model.points) {
    std::string line = std::to_string(point.id);
    AppendNumbers(point.position, ' ', &line);
    for (const uint8_t value : point.color) AppendInteger(value, ' ', &line);
    AppendNumbers(std::span(&point.error, 1), ' ', &line);
    for (const ColmapPoint::TrackElement& element : point.track) {
      AppendInteger(element.image_id, ' ', &line);
      AppendInteger(element.point2d, ' ', &line);
    }
    file.Write(line += '\n');
  }
  file.Commit();
}

}  // namespace

void WriteColmapText(const ExportScene& scene, const ColmapModel& model,
                     const std::filesystem::path& folder) {
  WriteCameras(scene, folder / "cameras.txt");
  WriteRigs(scene, folder / "rigs.txt");
  WriteFrames(scene, model, folder / "frames.txt");
  WriteImages(model, folder / "images.txt");
  WritePoints(model, folder / "points3D.txt");
}

}  // namespace orb360
