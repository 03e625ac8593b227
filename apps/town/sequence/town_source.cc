#include "apps/town/sequence/town_source.h"

namespace orb360::town {

TownSource::TownSource(const std::string& name, const TownSpec& spec, const Recording& recording)
    : drive_(spec, recording),
      info_{name,
            {recording.camera.width(), recording.camera.height()},
            recording.fps,
            recording.frames,
            drive_.camera_height()} {}

std::optional<Frame> TownSource::Read() {
  if (next_ == drive_.frames()) return std::nullopt;
  Frame frame{next_, next_ / drive_.fps(), drive_.Colour(drive_.SceneAt(next_), next_)};
  ++next_;
  return frame;
}

bool TownSource::Skip() {
  if (next_ == drive_.frames()) return false;
  ++next_;
  return true;
}

}  // namespace orb360::town
