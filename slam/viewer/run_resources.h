#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slam/viewer/resource.h"

namespace orb360 {

/// The page itself: "", `viewer.js`, `viewer.css` and `alive`. `is_live`: it shows a run that goes
/// on (LiveFeed::Resources), not a finished one.
ResourceTable PageResources(bool is_live);

/// The page and what it asks for of a finished run: `run.json`, `cloud.octree`, and for each view
/// `views/FRAME.jpg` and `views/FRAME.range`.
///
/// `octree`: empty where there is none. `views`: folder of the depth map store.
ResourceTable RunResources(std::string scene_json, const std::filesystem::path& octree,
                           const std::filesystem::path& views, const std::vector<int>& frames);

}  // namespace orb360
