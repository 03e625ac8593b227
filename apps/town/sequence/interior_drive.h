#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/town/drive/carried_camera.h"
#include "apps/town/drive/indoor_walk.h"
#include "apps/town/sequence/drive.h"
#include "apps/town/world/interior/interior.h"

namespace orb360::town {

/// The interior to be rendered and its settings.
struct InteriorSpec {
  uint64_t seed = 0;
  std::optional<std::string> light;  ///< beyond the windows; without it, the interior's own
  Mount mount;                       ///< its shaking is the factor on the sway of walking
};

/// A camera's walk through the rooms of a building. The camera is carried by somebody who walks,
/// or by a small robot.
class InteriorDrive : public Drive {
 public:
  /// Builds the interior and bakes its light, which takes seconds. Throws UserError for an unknown
  /// light, and for a camera higher than the doors allow.
  InteriorDrive(const InteriorSpec& spec, const Recording& recording);

  const Interior& interior() const { return interior_; }
  const IndoorWalk& walk() const { return walk_; }
  const RayScene& scene() const { return stage_.scene(); }

  std::optional<double> camera_height() const override { return carriage_.height; }
  std::string Origin() const override;

 protected:
  const Stage& stage() const override { return stage_; }
  Rigid3 PoseAt(double seconds) const override;
  std::vector<Instance> MovingAt(double) const override { return {}; }

 private:
  /// Returns the light beyond the windows, as dim as it is for an exposure of rooms.
  static Light LightOf(const InteriorSpec& spec, bool are_lamps_on);
  /// Sets the exposure for the rooms along the walk.
  void Expose();

  InteriorSpec spec_;
  Interior interior_;
  Light light_;
  Stage stage_;
  Carriage carriage_;
  IndoorWalk walk_;
};

}  // namespace orb360::town
