#pragma once

#include "apps/town/drive/camera_motion.h"
#include "apps/town/drive/lap.h"
#include "apps/town/drive/traffic.h"
#include "apps/town/sequence/drive.h"
#include "apps/town/sequence/named_town.h"
#include "apps/town/world/town.h"

namespace orb360::town {

/// Returns the options of the lap that the camera's car drives in a town.
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
  /// Takes a light, so that an unknown one is refused before the town is built.
  TownDrive(const TownSpec& spec, const Light& light, const Recording& recording);

  TownSpec spec_;
  Town town_;
  Stage stage_;
  Lap lap_;
  Traffic traffic_;
  CameraMotionOptions motion_;
};

}  // namespace orb360::town
