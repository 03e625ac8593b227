#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/orb360/commands.h"
#include "apps/orb360/export_cloud.h"
#include "apps/orb360/export_options.h"
#include "apps/orb360/finished_run.h"
#include "apps/orb360/input.h"
#include "apps/orb360/interrupt.h"
#include "apps/orb360/progress.h"
#include "apps/orb360/saved_views.h"
#include "slam/io/export/colmap.h"
#include "slam/io/export/export_scene.h"
#include "slam/io/export/frame_selection.h"
#include "slam/io/export/geographic_formats.h"
#include "slam/io/export/make_folder.h"
#include "slam/io/export/mcap.h"
#include "slam/io/export/nerfstudio.h"
#include "slam/io/export/opensfm.h"
#include "slam/io/export/point_selection.h"
#include "slam/io/export/sharpness.h"
#include "slam/io/export/trajectory_formats.h"
#include "slam/io/export/view_images.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/sequence.h>

namespace orb360 {
namespace {

/// Creates the folder of the results. One with files in it is refused, because a trainer would take
/// images of an earlier export for those of this one.
void MakeNewFolder(const std::filesystem::path& out) {
  if (std::filesystem::exists(out) &&
      !(std::filesystem::is_directory(out) && std::filesystem::is_empty(out))) {
    throw UserError("--out: " + out.string() + " exists and is not an empty folder; name another");
  }
  MakeFolder(out);
}

std::vector<int> IndicesOf(const SparseModel& model) {
  std::vector<int> indices;
  for (const PosedFrame& frame : model.frames) indices.push_back(frame.index);
  return indices;
}

const std::string& InputOf(const FinishedRun& run, const ExportOptions& options) {
  return options.input.empty() ? run.summary.input : options.input;
}

/// Opens the frames of a model in the input of the run.
std::unique_ptr<Sequence> OpenFrames(const FinishedRun& run, const ExportOptions& options,
                                     const SparseModel& model) {
  const std::string& input = InputOf(run, options);
  if (!IsRendered(input) && !std::filesystem::exists(input)) {
    throw UserError(input + ": the input of the run is not there any more; give it with --input" +
                    (options.input.empty() ? ", or leave images out with --images none" : ""));
  }
  SequenceOptions sequence;
  sequence.only = IndicesOf(model);
  sequence.lens = options.lens.empty() ? run.summary.lens : options.lens;
  std::unique_ptr<Sequence> frames = OpenInput(input, sequence);
  const cv::Size size(model.width, model.height);
  if (frames->image_size() == size) return frames;
  sequence.resize = size;
  return OpenInput(input, sequence);
}

/// Keeps the frames of one map, and of them those that the user wants.
SparseModel SelectFrames(const FinishedRun& run, const ExportOptions& options) {
  const int largest = LargestMap(run.model);
  const int map = options.map >= 0 ? options.map : largest;
  std::vector<bool> is_kept;
  int num_maps = 0;
  for (const PosedFrame& frame : run.model.frames) {
    is_kept.push_back(frame.map == map);
    num_maps = std::max(num_maps, frame.map + 1);
  }
  if (std::ranges::count(is_kept, true) == 0) {
    throw UserError("--map: the run has no map " + std::to_string(map) + "; it has " +
                    std::to_string(num_maps) + ", counted from 0");
  }
  if (num_maps > 1 && options.map < 0 && !options.is_quiet) {
    std::cout << "of " << num_maps << " maps the largest is exported, number " << map
              << "; --map exports another\n";
  }
  SparseModel model = KeepFrames(run.model, is_kept);
  if (options.frames == "all") return model;
  is_kept.clear();
  if (options.frames == "keyframes") {
    for (const PosedFrame& frame : model.frames) is_kept.push_back(frame.is_keyframe);
    if (std::ranges::count(is_kept, true) == 0) {
      throw UserError(options.run + ": has no keyframe in this map; --frames all exports others");
    }
    return KeepFrames(std::move(model), is_kept);
  }
  const std::unique_ptr<Sequence> sequence = OpenFrames(run, options, model);
  Progress progress(std::nullopt, options.is_quiet);
  std::vector<double> sharpness(model.frames.size(), 0.0);
  size_t f = 0;
  while (const std::optional<Frame> frame = sequence->Next()) {
    while (f < model.frames.size() && model.frames[f].index < frame->index) ++f;
    if (f == model.frames.size()) break;
    sharpness[f] = MeasureSharpness(frame->image, run.mask);
    progress.Update("measuring sharpness", static_cast<int>(f + 1),
                    static_cast<int>(model.frames.size()), "frames");
    ThrowIfInterrupted();
  }
  is_kept = SelectSharpest(model, sharpness, options.spacing);
  return KeepFrames(std::move(model), is_kept);
}

/// Sets the points of a scene to those that the user wants.
void SelectPoints(const FinishedRun& run, const ExportOptions& options, ExportScene* scene) {
  constexpr int kMaxCloudPoints = 500'000;
  if (options.points == "cloud") {
    const int count = options.max_points > 0 ? options.max_points : kMaxCloudPoints;
    scene->cloud = ReadThinnedCloud(run.folder / "cloud.ply", static_cast<size_t>(count));
  } else if (options.max_points > 0) {
    scene->model =
        KeepMostObserved(std::move(scene->model), static_cast<size_t>(options.max_points));
  }
}

/// Reads where the run lies on Earth, for formats that state it. Those that have no other
/// coordinates need it. It holds for the largest map.
std::optional<Georeference> FindGeoreference(const FinishedRun& run, const ExportOptions& options) {
  const bool is_geographic = IsGeographic(options.format);
  const bool can_state_it = is_geographic || options.format == "opensfm" ||
                            options.format == "las" || options.format == "mcap";
  if (!can_state_it) return std::nullopt;
  const std::filesystem::path path = run.folder / kGeoreferenceName;
  if (!std::filesystem::exists(path)) {
    if (!is_geographic) return std::nullopt;
    throw UserError(run.folder.string() + ": is not placed on Earth (there is no " +
                    kGeoreferenceName + "); `orb360 georeference " + run.folder.string() +
                    " --positions FILE` does that");
  }
  const int largest = LargestMap(run.model);
  if (options.map >= 0 && options.map != largest) {
    if (!is_geographic) return std::nullopt;
    throw UserError("--map: only the largest map is placed on Earth, number " +
                    std::to_string(largest) + "; leave it out");
  }
  return ReadGeoreference(path);
}

/// Writes the files of the format itself.
void WriteModel(const ExportScene& scene, const std::optional<Georeference>& georeference,
                const ExportOptions& options) {
  const std::filesystem::path out = options.out;
  const std::string& format = options.format;
  const std::vector<PosedFrame>& frames = scene.model.frames;
  if (format == "tum" || format == "images") ExportTum(frames, out);
  if (format == "kitti") ExportKitti(frames, out);
  if (format == "euroc") ExportEuroc(frames, out);
  if (format.starts_with("colmap")) {
    ExportColmap(scene, options.is_text ? ColmapFiles::kText : ColmapFiles::kBinary, out);
  }
  if (format == "nerfstudio") ExportNerfstudio(scene, out);
  if (format == "opensfm") ExportOpensfm(scene, georeference, out);
  if (format == "geojson") ExportGeojson(frames, *georeference, out);
  if (format == "gpx") ExportGpx(frames, *georeference, out);
  if (format == "kml") ExportKml(frames, *georeference, out);
}

/// Fills a scene with everything but the depth maps, whose names the format may want.
ExportScene MakeScene(const FinishedRun& run, const ExportOptions& options) {
  ExportScene scene;
  scene.model = SelectFrames(run, options);
  if (options.views.empty()) return scene;  // a trajectory
  scene.views = ViewsOf(options, scene.model);
  if (options.images == "png") scene.extension = ".png";
  scene.has_masks = !run.mask.empty();
  SelectPoints(run, options, &scene);
  if (options.format == "nerfstudio" && std::filesystem::exists(run.folder / kViewsName)) {
    scene.frames_with_depth = FramesWithDepth(run.folder / kViewsName, scene.model);
  }
  return scene;
}

/// Writes everything that is exported. `sequence`: nullptr without images.
void WriteScene(const ExportScene& scene, const FinishedRun& run,
                const std::optional<Georeference>& georeference, const ExportOptions& options,
                Sequence* sequence) {
  const std::filesystem::path out = options.out;
  Progress progress(std::nullopt, options.is_quiet);
  const auto show = [&](int done, int count) {
    progress.Update("writing", done, count, "frames");
    return CaughtInterrupt() == 0;
  };
  if (options.format == "mcap") {
    ExportMcap(scene, georeference, InputOf(run, options), sequence, out, show);
    return;
  }
  WriteModel(scene, georeference, options);
  if (scene.has_masks) WriteViewMasks(scene, run.mask, out);
  if (!scene.frames_with_depth.empty()) {
    WriteViewDepth(scene, DepthMapStore::Open(run.folder / kViewsName), out);
  }
  if (sequence != nullptr) WriteViewImages(scene, InputOf(run, options), sequence, out, show);
}

int RunExport(const ExportOptions& given) {
  const ExportOptions options = Settle(given);
  CatchInterrupts();
  const FinishedRun run = OpenFinishedRun(options.run);
  const std::filesystem::path out = options.out;
  const std::optional<Georeference> georeference = FindGeoreference(run, options);
  const bool has_lengths = (options.format == "las" || options.format == "mcap") && !georeference;
  if (has_lengths && run.summary.has_unknown_scale && !options.is_quiet) {
    std::cout << "the scale of this run is unknown: what the file calls a metre is arbitrary\n";
  }
  try {
    if (options.format == "las") {
      const LasCloud cloud = MeasureCloudOf(run, georeference);
      MakeNewFolder(out);
      WriteCloud(cloud, georeference, out, options.is_quiet);
      return EXIT_SUCCESS;
    }
    const ExportScene scene = MakeScene(run, options);
    const bool is_scene = !options.views.empty();
    // It is opened first: nothing is written for an input that is not there.
    std::unique_ptr<Sequence> sequence;
    if (is_scene && options.images != "none") sequence = OpenFrames(run, options, scene.model);
    if (options.format == "mcap") CheckRosTimes(scene, georeference);
    MakeNewFolder(out);
    WriteScene(scene, run, georeference, options, sequence.get());
    ThrowIfInterrupted();
    if (!options.is_quiet) {
      std::cout << "wrote " << scene.model.frames.size() << " frames";
      if (is_scene) {
        std::cout << " with " << scene.views.size()
                  << (scene.views.size() == 1 ? " image" : " images") << " each and "
                  << scene.points().size() << " points";
      }
      std::cout << " to " << out.string() << std::endl;
    }
  } catch (const Interrupted&) {
    std::cerr << "orb360: interrupted; " << out.string() << " is not complete\n";
    return 128 + CaughtInterrupt();  // as shells report it
  }
  return EXIT_SUCCESS;
}

}  // namespace

void AddExportCommand(CLI::App* app, Command* chosen) {
  CLI::App* command =
      app->add_subcommand("export", "Write a finished run in the format of another program");
  const auto options = std::make_shared<ExportOptions>();
  AddExportOptions(command, options.get());
  command->callback([options, chosen] { *chosen = [options] { return RunExport(*options); }; });
}

}  // namespace orb360
