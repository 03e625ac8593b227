#pragma once

#include "apps/town/drive/camera_motion.h"
#include "apps/town/drive/lap.h"
#include "apps/town/drive/traffic.h"
#include "apps/town/sequence/drive.h"
#include "apps/town/sequence/named_town.h"
#include "apps/town/world/town.h"

namespace orb360::town {

/// How the camera's car drives its lap of a town.
LapOptions LapOf(const TownSpec& spec);

/// A car's drive through a procedural town.
class TownDrive : public Drive {
 public:
  /// Builds the town, which takes seconds. Throws UserError for an unknown light.
  TownDrive(const TownSpec& spec, const Recording& recording);

  const Town& town() const { return town_; }
  const Lap& lap() const { return lap_; }

  std::optional<double> camera_height() const override { return motion_.height; }
  std::string Origin() const override;

 protected:
  const Stage& stage() const override { return stage_; }
  Rigid3 PoseAt(double seconds) const override;
  std::vector<Instance> MovingAt(double seconds) const override;

 private:
  /// An unknown light is refused before the town is built.
  TownDrive(const TownSpec& spec, const Light& light, const Recording& recording);

  TownSpec spec_;
  Town town_;
  Stage stage_;
  Lap lap_;
  Traffic traffic_;
  CameraMotionOptions motion_;
};

}  // namespace orb360::town
