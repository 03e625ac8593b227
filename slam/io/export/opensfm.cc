#include "slam/io/export/opensfm.h"

#include <string>

#include <nlohmann/json.hpp>

#include "slam/io/atomic_file.h"
#include "slam/io/chunked_file.h"
#include "slam/io/json_text.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

nlohmann::json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Writes one entry of a JSON object after `separator`.
void WriteEntry(const std::string& key, const nlohmann::json& value, const char* separator,
                ChunkedFile* file) {
  file->Write(separator);
  file->Write(ToJsonText(key));
  file->Write(": ");
  file->Write(ToJsonText(value));
}

}  // namespace

void ExportOpensfm(const ExportScene& scene, const std::optional<Georeference>& georeference,
                   const std::filesystem::path& folder) {
  ORB360_CHECK(scene.views.size() == 1 && scene.views.front().is_panorama(), scene.views.size());
  const View& view = scene.views.front();
  constexpr const char* kCamera = "panorama";
  // It is written piece by piece, because a document of all points would need much memory.
  ChunkedFile file(folder / "reconstruction.json");
  const nlohmann::json camera = {
      {"projection_type", "spherical"}, {"width", view.width}, {"height", view.height}};
  Similarity3 local_from_world;
  file.Write("[{\n");
  if (georeference) {
    local_from_world = georeference->alignment.local_from_path;
    const nlohmann::json reference = {{"latitude", georeference->origin.latitude},
                                      {"longitude", georeference->origin.longitude},
                                      {"altitude", georeference->origin.height}};
    WriteFileAtomically(folder / "reference_lla.json", ToJsonText(reference, 2) + "\n");
    WriteEntry("reference_lla", reference, "", &file);
    file.Write(",\n");
  }
  WriteEntry("cameras", nlohmann::json{{kCamera, camera}}, "", &file);
  file.Write(",\n\"shots\": {");
  const char* separator = "\n";
  for (const PosedFrame& frame : scene.model.frames) {
    const Rigid3 local_from_optical{local_from_world.rotation * frame.world_from_optical.rotation,
                                    local_from_world * frame.world_from_optical.translation};
    const Rigid3 camera_from_world = local_from_optical.Inverse();
    const nlohmann::json shot = {{"camera", kCamera},
                                 {"rotation", ToJson(LogSo3(camera_from_world.rotation))},
                                 {"translation", ToJson(camera_from_world.translation)},
                                 {"orientation", 1},  // EXIF: the image is upright.
                                 {"capture_time", frame.timestamp}};
    WriteEntry(ImageName(scene, frame, view), shot, separator, &file);
    separator = ",\n";
  }
  file.Write("},\n\"points\": {");
  separator = "\n";
  size_t number = 0;
  for (const ColoredLandmark& point : scene.points()) {
    WriteEntry(std::to_string(number++),
               {{"coordinates", ToJson(local_from_world * point.position)}, {"color", point.color}},
               separator, &file);
    separator = ",\n";
  }
  file.Write("}}]\n");
  file.Commit();
}

}  // namespace orb360
