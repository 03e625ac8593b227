#include "apps/town/sequence/drive.h"

namespace orb360::town {

cv::Mat3b Drive::Colour(const FrameScene& scene, int frame) const {
  if (cube_size() > 0) {
    return StitchColour(
        RenderCubeColour(scene, stage().shader(), cube_size(), WorldFromCamera(frame)), camera());
  }
  return RenderColour(scene, stage().shader(), camera(), WorldFromCamera(frame));
}

GeometryImage Drive::Geometry(const FrameScene& scene, int frame) const {
  return RenderGeometry(scene, camera(), WorldFromCamera(frame));
}

}  // namespace orb360::town
