#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "apps/orb360/commands.h"
#include "apps/orb360/compared_run.h"
#include "apps/orb360/interrupt.h"
#include "apps/orb360/viewed_run.h"
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

struct ReportOptions {
  std::string run;
  std::string compare;  // "": nothing
  std::string out;      // "": report.html of the run
  double max_mb = 30;   // 10^6 bytes
  int views = 12;
};

/// Of the frames with views, `count` evenly spread ones.
std::vector<int> SpreadEvenly(const std::vector<int>& frames, int count) {
  std::vector<int> chosen;
  const size_t kept = std::min(frames.size(), static_cast<size_t>(count));
  for (size_t i = 0; i < kept; ++i) {
    chosen.push_back(frames[kept == 1 ? 0 : i * (frames.size() - 1) / (kept - 1)]);
  }
  return chosen;
}

int Report(const ReportOptions& options) try {
  constexpr int kImageWidth = 1024;  // pixels
  constexpr int kRangeWidth = 512;
  CatchInterrupts();
  ViewedRun run = OpenViewedRun(options.run, true);
  RunScene& scene = run.scene;
  if (!options.compare.empty()) CompareWith(options.compare, &run);
  scene.images.clear();  // They would be too large.
  const size_t all_views = scene.views.size();
  scene.views = SpreadEvenly(scene.views, options.views);
  std::vector<EmbeddedView> views;
  for (const int frame : scene.views) {
    ThrowIfInterrupted();
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
    if (room < 1000) {
      throw UserError("--max-size: " + std::to_string(std::lround(options.max_mb)) +
                      " MB have no room for points beside the images; give more, or fewer --views");
    }
    const auto max_points = static_cast<std::uint64_t>(room);
    if (max_points < whole.header().point_count) {
      note("This file has " + std::to_string(max_points) + " of " +
           std::to_string(whole.header().point_count) + " points.");
    }
    octree = ThinOctree(whole, max_points);
    ThrowIfInterrupted();
  }
  const std::filesystem::path out = options.out.empty()
                                        ? std::filesystem::path(options.run) / "report.html"
                                        : std::filesystem::path(options.out);
  const std::string page = ReportPage(SceneJson(scene), octree, views);
  if (static_cast<double>(page.size()) > 1e6 * options.max_mb) {
    throw UserError("--max-size: " + std::to_string(std::lround(options.max_mb)) +
                    " MB have no room for the images; give more, or fewer --views");
  }
  WriteFileAtomically(out, page);
  std::cout << "wrote " << out.string() << ", "
            << std::lround(static_cast<double>(page.size()) / 1e5) / 10.0 << " MB" << std::endl;
  return EXIT_SUCCESS;
} catch (const Interrupted&) {
  return 128 + CaughtInterrupt();  // as shells report it
}

}  // namespace

void AddReportCommand(CLI::App* app, Command* chosen) {
  CLI::App* command =
      app->add_subcommand("report", "Write a finished run as one file that a browser shows");
  const auto options = std::make_shared<ReportOptions>();
  command->add_option("RUN", options->run, "Folder of a run")->required()->type_name("DIR");
  command->add_option("--compare", options->compare, kCompareHelp)->type_name("PATH");
  command->add_option("--out", options->out, "File to write (default: DIR/report.html)")
      ->type_name("FILE");
  command
      ->add_option("--max-size", options->max_mb, "Largest size of the file; the cloud is thinned")
      ->check(CLI::Range(2.0, 1000.0))
      ->check(kIsNumber)
      ->type_name("MB")
      ->capture_default_str();
  command
      ->add_option("--views", options->views,
                   "Images of keyframes in the file, where the run kept them (--save-views)")
      ->check(CLI::Range(0, 1000))
      ->type_name("N")
      ->capture_default_str();
  command->callback([options, chosen] { *chosen = [options] { return Report(*options); }; });
}

}  // namespace orb360
