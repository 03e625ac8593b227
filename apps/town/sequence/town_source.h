#pragma once

#include "apps/town/sequence/town_drive.h"
#include <orb360/slam/io/frame_source.h>

namespace orb360::town {

/// The images of a drive, rendered when they are requested; nothing is stored.
class TownSource : public FrameSource {
 public:
  /// Messages call the source `name`. Building the town takes seconds. Throws UserError for an
  /// unknown light.
  TownSource(const std::string& name, const TownSpec& spec, const Recording& recording);

  const SourceInfo& info() const override { return info_; }
  std::optional<Frame> Read() override;
  bool Skip() override;

 private:
  TownDrive drive_;
  SourceInfo info_;
  int next_ = 0;
};

}  // namespace orb360::town
