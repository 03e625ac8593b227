#include "apps/town/sequence/town_source.h"

namespace orb360::town {

TownSource::TownSource(const std::string& name, const TownSpec& spec,
                       const EquirectangularCamera& camera, double fps)
    : drive_(spec, camera, fps),
      info_{name, {camera.width(), camera.height()}, fps, spec.frames, drive_.camera_height()} {}

std::optional<Frame> TownSource::Read() {
  if (next_ == drive_.spec().frames) return std::nullopt;
  Frame frame{next_, next_ / drive_.fps(), drive_.Colour(drive_.SceneAt(next_), next_)};
  ++next_;
  return frame;
}

bool TownSource::Skip() {
  if (next_ == drive_.spec().frames) return false;
  ++next_;
  return true;
}

}  // namespace orb360::town
