#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/viewer/resource.h"

namespace orb360 {

/// The page itself: "", `viewer.js`, `viewer.css` and `alive`. `is_live`: it shows a run that goes
/// on (LiveFeed::Resources), not a finished one.
ResourceTable PageResources(bool is_live);

/// Where the images of a finished run are.
struct RunImages {
  std::vector<int> frames;                 ///< Indices of those that `load` gives.
  std::function<cv::Mat(int frame)> load;  ///< CV_8UC3, BGR. May throw UserError.
};

/// The page and what it asks for of a finished run: `run.json`, `cloud.octree`, for each image
/// `images/FRAME.jpg`, and for each view `views/FRAME.jpg` and `views/FRAME.range`.
///
/// `octree`, `other_octree` (`other.octree`): empty where there is none. `views`: folder of the
/// depth map store, with the views of `frames`.
ResourceTable RunResources(std::string scene_json, const std::filesystem::path& octree,
                           const RunImages& images, const std::filesystem::path& views,
                           const std::vector<int>& frames,
                           const std::filesystem::path& other_octree = {});

}  // namespace orb360
