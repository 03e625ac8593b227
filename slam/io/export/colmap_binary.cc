#include <bit>
#include <string>

#include "slam/io/chunked_file.h"
#include "slam/io/export/colmap_model.h"
#include "slam/io/export/pose_text.h"

namespace orb360 {
namespace {

static_assert(std::endian::native == std::endian::little, "COLMAP's files are little endian");

constexpr int32_t kCameraSensor = 0;  // COLMAP's SensorType::CAMERA

template <typename Numbers>
void WriteDoubles(const Numbers& numbers, ChunkedFile* file) {
  for (const double number : numbers) file->WriteBinary(number);
}

void WritePose(const Rigid3& pose, ChunkedFile* file) {
  WriteDoubles(ScalarFirst(pose.rotation), file);
  WriteDoubles(pose.translation, file);
}

void WriteCameras(const ExportScene& scene, const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.WriteBinary<uint64_t>(scene.views.size());
  uint32_t id = 0;
  for (const View& view : scene.views) {
    const ColmapCameraModel model = CameraModelOf(view);
    file.WriteBinary<uint32_t>(++id);
    file.WriteBinary<int32_t>(model.id);
    file.WriteBinary<uint64_t>(static_cast<uint64_t>(view.width));
    file.WriteBinary<uint64_t>(static_cast<uint64_t>(view.height));
    WriteDoubles(model.parameters, &file);
  }
  file.Commit();
}

void WriteRigs(const ExportScene& scene, const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.WriteBinary<uint64_t>(1);  // rigs
  file.WriteBinary<uint32_t>(1);  // id of the rig
  file.WriteBinary<uint32_t>(static_cast<uint32_t>(scene.views.size()));
  file.WriteBinary<int32_t>(kCameraSensor);
  file.WriteBinary<uint32_t>(1);  // id of the reference sensor
  for (size_t v = 1; v < scene.views.size(); ++v) {
    file.WriteBinary<int32_t>(kCameraSensor);
    file.WriteBinary<uint32_t>(static_cast<uint32_t>(v + 1));
    file.WriteBinary<uint8_t>(1);  // A pose follows.
    WritePose(ViewFromRig(scene, scene.views[v]), &file);
  }
  file.Commit();
}

void WriteFrames(const ExportScene& scene, const ColmapModel& model,
                 const std::filesystem::path& path) {
  ChunkedFile file(path);
  const size_t views = scene.views.size();
  file.WriteBinary<uint64_t>(scene.model.frames.size());
  for (size_t f = 0; f < scene.model.frames.size(); ++f) {
    file.WriteBinary<uint32_t>(static_cast<uint32_t>(f + 1));
    file.WriteBinary<uint32_t>(1);  // id of the rig
    WritePose(RigFromWorld(scene, scene.model.frames[f]), &file);
    file.WriteBinary<uint32_t>(static_cast<uint32_t>(views));
    for (size_t v = 0; v < views; ++v) {
      const ColmapImage& image = model.images[f * views + v];
      file.WriteBinary<int32_t>(kCameraSensor);
      file.WriteBinary<uint32_t>(image.camera_id);
      file.WriteBinary<uint64_t>(image.id);
    }
  }
  file.Commit();
}

void WriteImages(const ColmapModel& model, const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.WriteBinary<uint64_t>(model.images.size());
  for (const ColmapImage& image : model.images) {
    file.WriteBinary<uint32_t>(image.id);
    WritePose(image.camera_from_world, &file);
    file.WriteBinary<uint32_t>(image.camera_id);
    file.Write(image.name);
    file.WriteBinary('\0');
    file.WriteBinary<uint64_t>(image.points.size());
    for (const ColmapImage::Point2D& point : image.points) {
      WriteDoubles(point.pixel, &file);
      file.WriteBinary<uint64_t>(point.point_id);
    }
  }
  file.Commit();
}

void WritePoints(const ColmapModel& model, const std::filesystem::path& path) {
  ChunkedFile file(path);
  file.WriteBinary<uint64_t>(model.points.size());
  for (const ColmapPoint& point : model.points) {
    file.WriteBinary<uint64_t>(point.id);
    WriteDoubles(point.position, &file);
    for (const uint8_t value : point.color) file.WriteBinary<uint8_t>(value);
    file.WriteBinary<double>(point.error);
    file.WriteBinary<uint64_t>(point.track.size());
    for (const ColmapPoint::TrackElement& element : point.track) {
      file.WriteBinary<uint32_t>(element.image_id);
      file.WriteBinary<uint32_t>(element.point2d);
    }
  }
  file.Commit();
}

}  // namespace

void WriteColmapBinary(const ExportScene& scene, const ColmapModel& model,
                       const std::filesystem::path& folder) {
  WriteCameras(scene, folder / "cameras.bin");
  WriteRigs(scene, folder / "rigs.bin");
  WriteFrames(scene, model, folder / "frames.bin");
  WriteImages(model, folder / "images.bin");
  WritePoints(model, folder / "points3D.bin");
}

}  // namespace orb360
