#pragma once

#include <filesystem>
#include <functional>

#include "apps/town/sequence/drive.h"

namespace orb360::town {

struct FolderOptions {
  int depth_every = 1;  ///< ranges of every n-th frame
  bool exr = false;     ///< with the ranges: range/ (the same as 32-bit floats)
  bool masks = false;   ///< with the ranges: objects/ (16-bit ids) and moving/ (8-bit, 255 moving)
};

/// Renders a drive into a sequence folder: rgb/000000.jpg, depth/000000.png, groundtruth.txt,
/// sequence.yaml, and contact_sheet.jpg. Files appear under their names only when complete, and
/// existing frames are kept, so repeating the call resumes an interrupted rendering. A folder with
/// another sequence is refused. `progress` is called after each frame with the number of frames
/// done and the number of those rendered now. Throws UserError.
void RenderIntoFolder(const Drive& drive, const std::filesystem::path& folder,
                      const FolderOptions& options,
                      const std::function<void(int done, int rendered)>& progress);

}  // namespace orb360::town
