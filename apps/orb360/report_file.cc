#include "apps/orb360/report_file.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "slam/io/atomic_file.h"
#include "slam/io/depth_map_store.h"
#include "slam/io/octree/octree_file.h"
#include "slam/io/octree/thin_octree.h"
#include "slam/viewer/report_page.h"
#include "slam/viewer/run_scene.h"
#include "slam/viewer/view_files.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Of the frames with views, `count` evenly spread ones.
std::vector<int> SpreadEvenly(const std::vector<int>& frames, int count) {
  std::vector<int> chosen;
  const size_t kept = std::min(frames.size(), static_cast<size_t>(count));
  for (size_t i = 0; i < kept; ++i) {
    chosen.push_back(frames[kept == 1 ? 0 : i * (frames.size() - 1) / (kept - 1)]);
  }
  return chosen;
}

UserError NoRoom(double max_mb, const std::string& what) {
  return UserError("--max-size: " + std::to_string(std::lround(max_mb)) + " MB have no room for " +
                   what + "; give more, or fewer --views");
}

}  // namespace

std::uintmax_t WriteReport(ViewedRun run, const ReportOptions& options,
                           const std::filesystem::path& out) {
  constexpr int kImageWidth = 1024;  // pixels
  constexpr int kRangeWidth = 512;
  RunScene& scene = run.scene;
  scene.images.clear();  // They would be too large.
  const size_t all_views = scene.views.size();
  scene.views = SpreadEvenly(scene.views, options.views);
  std::vector<EmbeddedView> views;
  for (const int frame : scene.views) {
    options.check();
    const DenseDepth depth = DepthMapStore::Open(run.views).Get(frame);
    views.push_back(
        {frame, ImageBytes(depth.color, kImageWidth), ViewRangeBytes(depth, kRangeWidth)});
  }
  const auto note = [&](const std::string& what) {
    scene.missing.push_back(what + " `orb360 view` shows all.");
  };
  if (views.size() < all_views) {
    note("This file has " + std::to_string(views.size()) + " of " + std::to_string(all_views) +
         " images of keyframes.");
  }
  std::string octree;
  if (scene.has_cloud) {
    const OctreeFile whole(run.octree);
    // What the file needs without points, and that base64 makes four bytes of three.
    const double others = static_cast<double>(ReportPage(SceneJson(scene), "", views).size()) + 2e5;
    const double room = 0.75 * (1e6 * options.max_mb - others) / kOctreePointBytes;
    if (room < 1000) throw NoRoom(options.max_mb, "points beside the path and the images");
    const auto max_points = static_cast<std::uint64_t>(room);
    if (max_points < whole.header().point_count) {
      note("This file has " + std::to_string(max_points) + " of " +
           std::to_string(whole.header().point_count) + " points.");
    }
    octree = ThinOctree(whole, max_points);
    options.check();
  }
  const std::string page = ReportPage(SceneJson(scene), octree, views);
  if (static_cast<double>(page.size()) > 1e6 * options.max_mb) {
    throw NoRoom(options.max_mb, "the path and the images");
  }
  WriteFileAtomically(out, page);
  return page.size();
}

}  // namespace orb360
