#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/town/import/camera_path.h"
#include "apps/town/import/import_scenery.h"
#include "apps/town/sequence/drive.h"

namespace orb360::town {

/// A scene from a file, and a path through it.
struct ImportedSpec {
  std::filesystem::path scene;
  std::filesystem::path path;
  std::string light = "noon";
  ImportOptions options;
};

/// A camera's path through an imported scene, in which nothing moves.
class ImportedDrive : public Drive {
 public:
  /// Without a number of frames, the whole path is recorded at the given rate. Throws UserError for
  /// files that cannot be used and for a path through a wall.
  ImportedDrive(const ImportedSpec& spec, const CameraPath& path, const Recording& recording);

  std::optional<double> camera_height() const override { return camera_height_; }
  std::string Origin() const override;
  /// Returns the textures that could not be read, with the reasons.
  const std::vector<std::string>& missing_textures() const { return missing_; }
  /// Returns the decorations that could not be found, with the reasons.
  const std::vector<std::string>& missing_decorations() const { return missing_decorations_; }

 protected:
  const Stage& stage() const override { return stage_; }
  Rigid3 PoseAt(double seconds) const override { return path_.At(path_.begin() + seconds); }
  std::vector<Instance> MovingAt(double) const override { return {}; }

 private:
  Scenery Import(const ImportedSpec& spec);

  ImportedSpec spec_;
  Light light_;  // an unknown one is refused before the mesh is read
  CameraPath path_;
  std::vector<std::string> missing_;
  std::vector<std::string> missing_decorations_;
  Scenery scenery_;
  Stage stage_;
  std::optional<double> camera_height_;
};

}  // namespace orb360::town
