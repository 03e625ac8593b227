#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/town/render/geometry_image.h"
#include "apps/town/render/renderer.h"
#include "apps/town/render/stage.h"
#include "apps/town/sensor/sensor_options.h"
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360::town {

/// Settings of a recording of a drive.
struct Recording {
  EquirectangularCamera camera;
  double fps = 20;
  int frames = 600;
  int cube_size = 0;  ///< stitch images from six faces of that width; 0: render them directly
  SensorOptions sensor = {};
  Sampling sampling = Sampling::kAdaptive;
};

/// A camera's drive through a scenery. Any frame can be rendered, in any order.
class Drive {
 public:
  explicit Drive(const Recording& recording) : recording_(recording) {}
  virtual ~Drive() = default;
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  const EquirectangularCamera& camera() const { return recording_.camera; }
  double fps() const { return recording_.fps; }
  int frames() const { return recording_.frames; }
  int cube_size() const { return recording_.cube_size; }
  Sampling sampling() const { return recording_.sampling; }
  const SensorOptions& sensor() const { return recording_.sensor; }

  Rigid3 WorldFromCamera(int frame) const { return PoseAt(frame / fps()); }
  /// Returns the height above the road, metres, if there is a road.
  virtual std::optional<double> camera_height() const = 0;
  /// Returns what the drive was made from, as lines of YAML.
  virtual std::string Origin() const = 0;

  FrameScene SceneAt(int frame) const { return stage().With(MovingAt(frame / fps())); }
  /// Returns the image that the camera takes of the scene at a frame.
  cv::Mat3b Colour(const FrameScene& scene, int frame) const;
  /// Returns what the rays of the panorama meet, independent of how its colours are made.
  GeometryImage Geometry(const FrameScene& scene, int frame) const;

 protected:
  virtual const Stage& stage() const = 0;
  /// Returns the pose at a time in seconds from the first frame. The shutter may open shortly
  /// before the first frame and close shortly after the last one.
  virtual Rigid3 PoseAt(double seconds) const = 0;
  virtual std::vector<Instance> MovingAt(double seconds) const = 0;

 private:
  cv::Mat3f RadianceAt(double seconds) const;
  /// Returns a small panorama for the exposure metering.
  cv::Mat3f MeteredAt(double seconds) const;

  Recording recording_;
};

}  // namespace orb360::town
