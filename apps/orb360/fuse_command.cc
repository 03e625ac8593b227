#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include "apps/orb360/commands.h"
#include "apps/orb360/dense_output.h"
#include "apps/orb360/interrupt.h"
#include "apps/orb360/progress.h"
#include "apps/orb360/saved_views.h"
#include "slam/io/dense_cloud_file.h"
#include "slam/io/mesh_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

struct FuseOptions {
  std::string run;
  std::string out;        // "": cloud.ply of the run
  double voxel_size = 0;  // 0: as in a run
  double max_range = 0;   // 0: as in a run
  double max_error = 0;   // 0: as in a run
  int min_support = GeometricConsistencyOptions{}.min_support;
  int threads = 0;  // 0: one for each core
  bool has_mesh = false;
  bool is_quiet = false;
};

int Fuse(const FuseOptions& options) {
  CatchInterrupts();
  const std::filesystem::path folder = std::filesystem::path(options.run) / kViewsName;
  const SavedViews saved = LoadViews(folder);
  const DepthMapStore store = DepthMapStore::Open(folder);
  const std::filesystem::path out = options.out.empty()
                                        ? std::filesystem::path(options.run) / "cloud.ply"
                                        : std::filesystem::path(options.out);
  const std::filesystem::path mesh_path = out.parent_path() / kMeshName;
  if (options.has_mesh && out == mesh_path) {
    throw UserError("--out: " + out.string() +
                    " is the file of the mesh; name the cloud otherwise");
  }
  DenseCloudOptions fusion;
  const auto load = [&store](int frame_index) { return store.Get(frame_index); };
  if (options.voxel_size > 0) {
    fusion.voxel_size = options.voxel_size;
  } else if (!saved.is_metric) {
    fusion.voxel_size = ChooseVoxelSize(saved.views, load);
  }
  if (options.max_range > 0) fusion.max_range_voxels = options.max_range / *fusion.voxel_size;
  if (options.max_error > 0) fusion.max_error_voxels = options.max_error / *fusion.voxel_size;
  fusion.consistency.min_support = options.min_support;
  fusion.num_threads = options.threads > 0
                           ? options.threads
                           : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  DenseCloudSummary summary;
  try {
    Progress progress(std::nullopt, options.is_quiet);
    fusion.progress = [&](int done, int count) {
      ThrowIfInterrupted();
      progress.Update("fusing depth", done, count, "views");
    };
    std::optional<MeshWriter> mesh;
    if (options.has_mesh) {
      mesh.emplace(mesh_path, *fusion.voxel_size, SurfaceNetsOptions(), fusion.num_threads);
    }
    summary = WriteDenseCloud(out, store, saved.views, fusion,
                              [&mesh](std::span<const SurfacePoint> points) {
                                if (mesh) mesh->Add(points);
                              });
    if (mesh) mesh->Write();
  } catch (const Interrupted&) {
    std::cerr << "orb360: interrupted; " << out.string() << " is as it was\n";
    return 128 + CaughtInterrupt();  // as shells report it
  }
  if (!options.is_quiet) {
    std::cout << "wrote " << out.string() << ": " << summary.points << " points of "
              << saved.views.size() << " views, one in a cube of " << summary.fusion.voxel_size
              << (saved.is_metric ? " m\n" : " units\n");
  }
  return EXIT_SUCCESS;
}

}  // namespace

void AddFuseCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand(
      "fuse", "Make the dense cloud of a finished run again, with other settings");
  const auto options = std::make_shared<FuseOptions>();
  command->add_option("RUN", options->run, "Folder of a run with --save-views")
      ->required()
      ->type_name("DIR");
  command->add_option("--out", options->out, "File to write (default: DIR/cloud.ply)")
      ->type_name("FILE");
  const auto add_length = [&](const char* name, double* value, const char* description) {
    command->add_option(name, *value, description)
        ->check(CLI::Range(1e-6, 1e6))
        ->check(kIsNumber)
        ->type_name("M");
  };
  add_length("--voxel-size", &options->voxel_size,
             "Side of the cubes each of which becomes one point, metres or units of a map that is "
             "not metric (default: 0.05, there a hundredth of the median range)");
  add_length("--max-range", &options->max_range,
             "Farthest point from its view (default: 600 voxels)");
  add_length("--max-error", &options->max_error,
             "Largest expected error of a point (default: 4 voxels)");
  command
      ->add_option("--min-support", options->min_support,
                   "Number of other views that must see a point where it is")
      ->check(CLI::Range(0, 100))
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--mesh", options->has_mesh,
                    "Also write the surface through the cloud to mesh.ply in the same folder");
  command->add_option("--threads", options->threads, "Threads (default: one for each core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command->add_flag("--quiet", options->is_quiet, "Show no progress");
  command->callback([options, chosen] { *chosen = [options] { return Fuse(*options); }; });
}

}  // namespace orb360
