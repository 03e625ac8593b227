#include "apps/town/sequence/imported_drive.h"

#include <iomanip>
#include <sstream>

namespace orb360::town {

ImportedDrive::ImportedDrive(const ImportedSpec& spec, const CameraPath& path,
                             const Recording& recording)
    : Drive(recording),
      spec_(spec),
      light_(MakeLight(spec.light, 0)),
      path_(path),
      scenery_(Import(spec)),
      stage_(&scenery_, light_, 0) {
  std::vector<Rigid3> poses;
  for (int frame = 0; frame < frames(); ++frame) poses.push_back(WorldFromCamera(frame));
  RequireFreePath(stage_.scene(), path_, path_.begin() + (frames() - 1) / fps());
  camera_height_ = HeightAboveGround(stage_.scene(), poses);
}

Scenery ImportedDrive::Import(const ImportedSpec& spec) {
  const SourceScene source = ReadMeshFile(spec.scene);
  missing_decorations_ = source.missing;
  return MakeScenery(source, spec.scene.parent_path(), spec.options, &missing_);
}

std::string ImportedDrive::Origin() const {
  std::ostringstream text;
  text << "scene: " << std::quoted(spec_.scene.filename().string())
       << "\npath: " << std::quoted(spec_.path.filename().string()) << "\nlight: " << spec_.light
       << "\nscale: " << spec_.options.scale
       << "\nup: " << (spec_.options.up == UpAxis::kY ? "y" : "z") << "\n";
  return text.str();
}

}  // namespace orb360::town
