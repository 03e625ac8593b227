#include "apps/town/sequence/drive.h"

#include "apps/town/sensor/sensor.h"

namespace orb360::town {

cv::Mat3b Drive::Colour(const FrameScene& scene, int frame) const {
  if (sensor().HasEffects()) {
    return CaptureImage(
        sensor(), frame, frame / fps(), [this](double seconds) { return RadianceAt(seconds); },
        [this](double seconds) { return MeteredAt(seconds); });
  }
  if (cube_size() > 0) {
    return StitchColour(
        RenderCubeColour(scene, stage().shader(), cube_size(), WorldFromCamera(frame), sampling()),
        camera());
  }
  return RenderColour(scene, stage().shader(), camera(), WorldFromCamera(frame), sampling());
}

GeometryImage Drive::Geometry(const FrameScene& scene, int frame) const {
  return RenderGeometry(scene, camera(), WorldFromCamera(frame));
}

cv::Mat3f Drive::RadianceAt(double seconds) const {
  const FrameScene scene = stage().With(MovingAt(seconds));
  const Rigid3 pose = PoseAt(seconds);
  if (cube_size() > 0)
    return StitchRadiance(
        RenderCubeRadiance(scene, stage().shader(), cube_size(), pose, sampling()), camera());
  return RenderRadiance(scene, stage().shader(), camera(), pose, sampling());
}

cv::Mat3f Drive::MeteredAt(double seconds) const {
  return RenderRadiance(stage().With(MovingAt(seconds)), stage().shader(),
                        EquirectangularCamera(64, 32), PoseAt(seconds));
}

}  // namespace orb360::town
