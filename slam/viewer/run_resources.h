#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slam/viewer/resource.h"

namespace orb360 {

/// The page, the scene, the octree and the views of a run, as the page asks for them: `viewer.js`,
/// `viewer.css`, `alive`, `run.json`, `cloud.octree`, and for each view `views/FRAME.jpg` and
/// `views/FRAME.range`.
///
/// `octree`: empty where there is none. `views`: folder of the depth map store.
ResourceTable RunResources(std::string scene_json, const std::filesystem::path& octree,
                           const std::filesystem::path& views, const std::vector<int>& frames);

}  // namespace orb360
