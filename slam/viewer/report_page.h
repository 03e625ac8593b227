#pragma once

#include <string>
#include <vector>

namespace orb360 {

/// A view within a report.
struct EmbeddedView {
  int frame = 0;      ///< Index in the input.
  std::string image;  ///< ImageBytes.
  std::string range;  ///< ViewRangeBytes.
};

/// Returns the viewer's page as one file that needs no server: with style, script, scene
/// (SceneJson, whose views must be these), octree (empty: none) and views within it.
std::string ReportPage(const std::string& scene_json, const std::string& octree,
                       const std::vector<EmbeddedView>& views);

}  // namespace orb360
