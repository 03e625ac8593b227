#include <algorithm>
#include <chrono>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <omp.h>
#include <opencv2/core/utility.hpp>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "apps/orb360/commands.h"
#include "apps/orb360/input.h"
#include "apps/orb360/interrupt.h"
#include "apps/orb360/live_view.h"
#include "apps/orb360/mask.h"
#include "apps/orb360/progress.h"
#include "apps/orb360/report_file.h"
#include "apps/orb360/run_options.h"
#include "apps/orb360/run_output.h"
#include "apps/orb360/run_summary.h"
#include "apps/orb360/sparse_output.h"
#include "apps/orb360/viewed_run.h"
#include "slam/io/atomic_file.h"
#include "slam/io/octree/octree_format.h"
#include "slam/io/octree/octree_writer.h"
#include "slam/io/sparse_model_file.h"
#include "slam/pipeline/make_sparse_model.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/depth/depth_completer.h>
#include <orb360/slam/io/config.h>
#include <orb360/slam/io/map_file.h>
#include <orb360/slam/io/sequence.h>
#include <orb360/slam/pipeline/options.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Sets the number of threads of OpenMP and OpenCV and returns it.
int SetThreads(int wanted) {
  const int threads =
      wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  omp_set_num_threads(threads);
  cv::setNumThreads(threads);
  return threads;
}

void Warn(const std::string& warning, RunRecord* record) {
  std::cerr << "orb360: warning: " << warning << '\n';
  record->warnings.push_back(warning);
}

/// Tracks frame by frame until the end of the input, an interrupt, or a failure of input or disk.
/// `live`: null where the run is not shown.
void ProcessFrames(Sequence* sequence, System* system, RunOutput* output, LiveView* live,
                   bool is_quiet, RunRecord* record) {
  Progress progress(sequence->frame_count(), is_quiet);
  const auto pass_on_warnings = [&] {
    for (std::string& warning : sequence->TakeWarnings()) {
      progress.Warn(warning);
      record->warnings.push_back(std::move(warning));
    }
  };
  try {
    while (CaughtInterrupt() == 0) {
      if (live != nullptr && !live->WaitForTurn()) {
        progress.Warn("ended early from the viewer");
        record->warnings.emplace_back("ended early from the viewer");
        break;
      }
      const std::optional<Frame> frame = sequence->Next();
      pass_on_warnings();
      if (!frame) break;
      const FrameReport report = system->Process(*frame);
      if (report.world_from_camera) output->Append(frame->timestamp, *report.world_from_camera);
      record->times.Add(report.timing_ms);
      if (live != nullptr) live->feed().AddTimes(report.timing_ms);
      progress.Update(frame->index, report);
    }
  } catch (const UserError&) {
    record->failure = std::current_exception();
    pass_on_warnings();
  }
  record->frames = progress.num_frames();
}

/// Computes and fuses dense depth. A failure of the disk is recorded and not thrown,
/// so that the trajectory is written.
std::optional<DenseOutput> FuseDepth(const Reconstruction& reconstruction,
                                     const RunOptions& options, int num_threads,
                                     const RunOutput& output, System* system, LiveView* live,
                                     RunRecord* record) {
  const auto start = Clock::now();
  std::optional<DenseOutput> dense;
  if (options.weights == "none" || reconstruction.keyframes.empty()) return dense;
#ifdef __GLIBC__
  // Without this the memory of tracking and of the last bundle adjustment would remain in use
  // beside that of fusion.
  malloc_trim(0);
#endif
  try {
    // After an interrupt the rest of the views are left to the network.
    Progress progress(std::nullopt, options.is_quiet);
    const auto show = [&](const char* what, int done, int count, const char* of_what) {
      progress.Update(what, done, count, of_what);
      if (live != nullptr) live->feed().ShowProgress({what, done, count, of_what});
    };
    ViewDepthCallbacks callbacks;
    callbacks.progress = [&](int done, int count) {
      show("computing depth", done, count, "steps");
      return CaughtInterrupt() == 0;
    };
    if (live != nullptr) {
      callbacks.watcher = [live](int frame, const Rigid3& pose, const DenseDepth& depth) {
        live->feed().AddView(frame, pose, depth);
      };
    }
    if (options.saves_sparse) callbacks.sink = SparseWriter(output.folder(), &record->failure);
    record->depth = system->ComputeDepth(reconstruction, callbacks);
    const bool has_depth = std::ranges::any_of(reconstruction.frames, [&](const FramePose& frame) {
      return system->depth_maps()->Contains(frame.index);
    });
    if (!has_depth) {
      const std::string warning =
          "no dense cloud: the camera has hardly moved, or too little has texture";
      progress.Warn(warning);
      record->warnings.push_back(warning);
      return std::nullopt;
    }
    DenseCloudOptions fusion;
    fusion.num_threads = num_threads;
    fusion.progress = [&](int done, int count) { show("fusing depth", done, count, "views"); };
    dense = output.WriteDense(
        reconstruction, *system->depth_maps(),
        {.depth = options.saves_depth, .views = options.saves_views, .mesh = options.has_mesh},
        fusion);
    if (!record->failure) record->failure = dense->mesh_failure;
    WriteOctree(output.folder() / kOctreeName, output.folder() / "cloud.ply");
  } catch (const std::exception&) {  // The trajectory is written nevertheless.
    if (!record->failure) record->failure = std::current_exception();
  }
  record->fusion_seconds = SecondsSince(start);
  return dense;
}

/// Reads the map in which a run begins. Its images must have the given width, pixels. None for "".
std::optional<StoredMap> ReadMapFor(int width, const std::string& path) {
  if (path.empty()) return std::nullopt;
  StoredMap stored = ReadMap(path);
  if (stored.width == width) return stored;
  throw UserError(path + ": was made from images " + std::to_string(stored.width) +
                  " pixels wide, and these have " + std::to_string(width) + "; use --resize " +
                  std::to_string(stored.width) + "x" + std::to_string(stored.width / 2));
}

/// Writes the largest of several maps, because their relative poses are unknown.
void WriteLargestMap(const std::string& path, int width, const Rigid3& file_world_from_map,
                     const MetricScale& scale, const System& system) {
  const std::span<const Map> maps = system.maps();
  const auto largest = std::ranges::max_element(maps, {}, &Map::num_keyframes);
  if (largest == maps.end()) return;
  std::optional<KnownGround> ground = system.grounds()[largest - maps.begin()];
  // The next run may find it.
  const bool is_doubted = scale.ground_probability.value_or(1) < kMinGroundProbability;
  if (ground && (ground->is_rough || is_doubted)) ground.reset();
  WriteMap(path, {width, file_world_from_map, ground, *largest});
}

/// Throws UserError for a camera height in the description of `input` that ScaleOptions excludes.
void RequireInRange(const ScaleOptions& scale, const std::string& input) {
  try {
    ValidateOptions(scale);
  } catch (const ContractError& error) {
    throw UserError(input + ": " + error.what());
  }
}

int Run(const RunOptions& options) {
  const nn::Device device = options.device.Open();
  Options system_options;
  if (!options.config.empty()) {
    OptionSchema schema;
    RegisterOptions(&schema, &system_options);
    LoadConfig(options.config, schema);
  }
  SequenceOptions sequence_options = options.sequence;
  sequence_options.resize = ParseSize(options.resize);
  if (options.loops == "off") system_options.loop.enabled = false;
  if (!options.cloud_quality.empty()) {
    system_options.depth.stereo = options.cloud_quality != "draft";
  }
  const std::unique_ptr<Sequence> sequence = OpenInput(options.input, sequence_options);
  if (options.cloud_quality == "high") {
    constexpr int kMaxHeight = 1024;  // pixels
    int& height = system_options.depth.height;
    height = std::max(height, std::min(kMaxHeight, sequence->image_size().height));
  }
  double& camera_height = system_options.scale.camera_height;
  if (options.camera_height > 0) camera_height = options.camera_height;
  if (camera_height == 0) {
    camera_height = sequence->camera_height().value_or(0);
    RequireInRange(system_options.scale, options.input);
  }
  std::optional<StoredMap> stored = ReadMapFor(sequence->image_size().width, options.map_in);
  const std::optional<double> fps =
      options.sequence.fps > 0 ? std::optional(options.sequence.fps) : std::nullopt;
  RunRecord record;
  std::string unusable;
  const std::optional<RunPositions> positions =
      ReadRunPositions(options.positions, options.input, fps, &unusable);
  if (!unusable.empty()) Warn(unusable, &record);
  if (!device.passed_over.empty()) Warn(PassedOverWarning(device), &record);
  std::optional<LiveView> live;
  if (!options.view_port.empty()) {
    live.emplace(options.view_address, std::stoi(options.view_port));
  }
  RunOutput output(options.out);
  if (stored) output.SetWorld(stored->file_world_from_map);
  // This throws now if the map could not be written at the end. It may be in the output folder.
  if (!options.map_out.empty()) AtomicFile{options.map_out};
  const int threads = SetThreads(options.threads);
  const cv::Mat mask = ChooseMask(options.mask, options.input, sequence_options, *sequence);
  const double masked_fraction = ExcludedFraction(mask);
  if (masked_fraction > 0.0 && !options.is_quiet) {
    std::cout << std::lround(100.0 * masked_fraction) << " % of the sphere is masked" << std::endl;
  }
  CatchInterrupts();

  const cv::Size size = sequence->image_size();
  system_options.num_threads = threads;
  System system(EquirectangularCamera(size.width, size.height), system_options, mask);
  if (options.weights != "none") {
    system.EnableDepth(options.weights, output.folder() / "depth.tmp", device);
  }
  if (stored) options.localizes ? system.Localize(*stored) : system.LoadMap(*stored);
  stored.reset();
  if (live) {
    live->feed().SetMask(mask);
    live->Watch(&system);
  }
  const auto start = Clock::now();
  ProcessFrames(sequence.get(), &system, &output, live ? &*live : nullptr, options.is_quiet,
                &record);
  if (live) live->feed().End();
  const auto last_frame = Clock::now();
  const Reconstruction reconstruction = system.Finish(positions ? positions->local : Positions());
  record.finishing_seconds = SecondsSince(last_frame);
  record.seconds = SecondsSince(start);
  if (live) live->feed().ShowFinished(system.maps(), output.WorldOf(reconstruction));
  const std::optional<DenseOutput> dense = FuseDepth(reconstruction, options, threads, output,
                                                     &system, live ? &*live : nullptr, &record);
  const DepthCompleter* const completer = system.depth_completer();
  if (completer != nullptr && !completer->device_failure().empty()) {
    Warn(completer->device_failure(), &record);
  }
  const Rigid3 file_world_from_map = output.WorldOf(reconstruction);
  SparseModel model =
      MakeSparseModel(reconstruction, system.maps(), EquirectangularCamera(size.width, size.height),
                      file_world_from_map);
  const GeoreferenceResult placed =
      PlaceRun(model, positions, reconstruction.up.has_value(), ParseUtcStart(options.positions));
  if (!placed.failure.empty() && positions->is_from_input) Warn(placed.failure, &record);
  const nlohmann::json summary = Summarize(
      reconstruction, record, dense,
      {options.input, options.sequence.lens, fps, options.mask, masked_fraction, options.weights,
       completer != nullptr ? completer->device() : "none",
       completer != nullptr ? completer->precision() : "none", threads, placed.description});
  output.Finish(reconstruction, summary, dense);
  if (!options.map_out.empty()) {
    WriteLargestMap(options.map_out, size.width, file_world_from_map, reconstruction.scale, system);
  }
  WriteSparseModel(output.folder() / kSparseModelName, model);
  model = {};  // The report reads it.
  SaveGeoreference(output.folder(), placed.georeference);
  SaveMask(output.folder(), mask);
  if (options.saves_sparse && options.weights == "none") {
    WriteSparseKeyframes(MakeSparseFolder(output.folder()), system.maps(),
                         OpenInput(options.input, sequence_options).get());
  }
  try {
    WriteReport(OpenViewedRun(output.folder(), true), {}, output.folder() / kReportName);
  } catch (const UserError&) {
    if (!record.failure) record.failure = std::current_exception();
  }
  if (!options.is_quiet) PrintResult(summary, output.folder());

  if (record.failure) std::rethrow_exception(record.failure);
  if (CaughtInterrupt() != 0) {
    std::cerr << "orb360: interrupted after " << record.frames << " frames; what was done is in "
              << output.folder().string() << '\n';
    return 128 + CaughtInterrupt();  // as shells report it
  }
  if (reconstruction.frames.empty()) {
    throw UserError(options.input + ": no pose was found in its " + std::to_string(record.frames) +
                    (options.localizes ? " frames: the camera is nowhere in " + options.map_in
                                       : " frames; the camera must move and see some texture"));
  }
  if (!placed.failure.empty() && !positions->is_from_input) throw UserError(placed.failure);
  return EXIT_SUCCESS;
}

}  // namespace

void AddRunCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand("run", "Track a 360-degree video and map what it sees");
  const auto options = std::make_shared<RunOptions>();
  AddRunOptions(command, options.get());
  command->callback([options, chosen] { *chosen = [options] { return Run(Settle(*options)); }; });
}

}  // namespace orb360
