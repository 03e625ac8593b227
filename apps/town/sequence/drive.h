#pragma once

#include <memory>

#include "apps/town/drive/camera_motion.h"
#include "apps/town/drive/lap.h"
#include "apps/town/drive/traffic.h"
#include "apps/town/render/renderer.h"
#include "apps/town/sequence/named_town.h"

namespace orb360::town {

/// How the camera's car drives its lap of a town.
LapOptions LapOf(const TownSpec& spec);

/// A drive through a town that can be rendered at any frame, in any order.
class Drive {
 public:
  /// Builds the town, which takes seconds. Throws UserError for an unknown light.
  Drive(const TownSpec& spec, const EquirectangularCamera& camera, double fps);
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  const TownSpec& spec() const { return spec_; }
  const EquirectangularCamera& camera() const { return camera_; }
  double fps() const { return fps_; }
  double camera_height() const { return motion_.height; }  ///< metres above the road
  const Town& town() const { return town_; }

  Rigid3 WorldFromCamera(int frame) const;
  FrameScene SceneAt(int frame) const;
  cv::Mat3b Colour(const FrameScene& scene, int frame) const;
  GeometryImage Geometry(const FrameScene& scene, int frame) const;

 private:
  double TimeOf(int frame) const { return start_ + frame / fps_; }

  TownSpec spec_;
  EquirectangularCamera camera_;
  double fps_;
  Light light_;
  Town town_;
  Sky sky_;
  RayScene scene_;
  Shader shader_;
  Lap lap_;
  Lap oncoming_lap_;
  double start_;  ///< seconds on the lap's clock at frame 0
  Traffic traffic_;
  CameraMotionOptions motion_;
};

}  // namespace orb360::town
