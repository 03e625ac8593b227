#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/town/drive/carried_camera.h"
#include "apps/town/drive/route_walk.h"
#include "apps/town/sequence/drive.h"

namespace orb360::town {

/// A landscape or a tunnel to be rendered, and its settings.
struct WalkSpec {
  enum class World { kLandscape, kTunnel };
  World world = World::kLandscape;
  uint64_t seed = 0;
  std::optional<std::string> light;  ///< without it, the seed's own
  Mount mount;                       ///< its shaking is the factor on the sway of walking
};

/// A camera's way along a route over ground that is not level, carried by somebody who walks or by
/// a small robot.
class WalkDrive : public Drive {
 public:
  /// Builds the world and its light, which takes seconds. Throws UserError for an unknown light,
  /// and for a camera higher than there is room.
  WalkDrive(const WalkSpec& spec, const Recording& recording);

  const RayScene& scene() const { return stage_.scene(); }
  const RouteWalk& walk() const { return walk_; }

  std::optional<double> camera_height() const override { return carriage_.height; }
  std::string Origin() const override;

 protected:
  const Stage& stage() const override { return stage_; }
  Rigid3 PoseAt(double seconds) const override;
  std::vector<Instance> MovingAt(double) const override { return {}; }

 private:
  /// A world that can be walked through.
  struct World {
    Scenery scenery;
    std::vector<Vector2f> round;                   ///< a closed route
    std::function<float(const Vector2f&)> ground;  ///< height, metres
    double head_room = 0;                          ///< highest camera above the ground, metres
  };
  static World BuildWorld(const WalkSpec& spec);
  static Light LightOf(const WalkSpec& spec);

  WalkSpec spec_;
  Light light_;  // an unknown one is refused before the world is built
  World world_;
  Carriage carriage_;  // one that is too high is refused before the light is computed
  Stage stage_;
  RouteWalk walk_;
};

}  // namespace orb360::town
