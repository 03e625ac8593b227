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
#include "apps/orb360/mask.h"
#include "apps/orb360/progress.h"
#include "apps/orb360/run_output.h"
#include "apps/orb360/run_summary.h"
#include "apps/orb360/sparse_output.h"
#include "nn/base/number_text.h"
#include "slam/io/atomic_file.h"
#include "slam/io/full_sphere.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/base/option_schema.h>
#include <orb360/nn/models/default_weights.h>
#include <orb360/slam/io/config.h>
#include <orb360/slam/io/map_file.h>
#include <orb360/slam/io/sequence.h>
#include <orb360/slam/pipeline/options.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {
namespace {

struct RunOptions {
  std::string input;
  std::string out;
  std::string config;
  std::string mask = "auto";
  int threads = 0;           // 0: one for each core
  double camera_height = 0;  // metres; 0: as the configuration or the input says
  std::string resize;
  std::string map_in;
  std::string map_out;
  bool localizes = false;
  std::string loops = "on";
  SequenceOptions sequence;
  std::string weights;
  bool saves_sparse = false;
  bool saves_depth = false;
  bool saves_views = false;
  bool has_mesh = false;
  std::string cloud_quality;  // "": as the configuration says
  bool is_quiet = false;
};

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Returns the size that --resize asks for; empty for "".
cv::Size ParseSize(const std::string& text) {
  if (text.empty()) return {};
  const size_t x = std::min(text.find('x'), text.size() - 1);
  const std::optional<int> width = ParseNumber<int>(std::string_view(text).substr(0, x));
  const std::optional<int> height = ParseNumber<int>(std::string_view(text).substr(x + 1));
  if (width && height && IsFullSphere({*width, *height})) return {*width, *height};
  throw UserError("--resize: `" + text +
                  "` is not WIDTHxHEIGHT with a width of twice the height, such as 2048x1024");
}

/// Sets the number of threads of OpenMP and OpenCV and returns it.
int SetThreads(int wanted) {
  const int threads =
      wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  omp_set_num_threads(threads);
  cv::setNumThreads(threads);
  return threads;
}

/// Tracks frame by frame until the end of the input, an interrupt, or a failure of input or disk.
RunRecord ProcessFrames(Sequence* sequence, System* system, RunOutput* output, bool is_quiet) {
  RunRecord record;
  Progress progress(sequence->frame_count(), is_quiet);
  const auto pass_on_warnings = [&] {
    for (std::string& warning : sequence->TakeWarnings()) {
      progress.Warn(warning);
      record.warnings.push_back(std::move(warning));
    }
  };
  try {
    while (CaughtInterrupt() == 0) {
      const std::optional<Frame> frame = sequence->Next();
      pass_on_warnings();
      if (!frame) break;
      const FrameReport report = system->Process(*frame);
      if (report.world_from_camera) output->Append(frame->timestamp, *report.world_from_camera);
      record.times.Add(report.timing_ms);
      progress.Update(frame->index, report);
    }
  } catch (const UserError&) {
    record.failure = std::current_exception();
    pass_on_warnings();
  }
  record.frames = progress.num_frames();
  return record;
}

/// Computes and fuses dense depth. A failure of the disk is recorded and not thrown,
/// so that the trajectory is written.
std::optional<DenseOutput> FuseDepth(const Reconstruction& reconstruction,
                                     const RunOptions& options, int num_threads,
                                     const RunOutput& output, System* system, RunRecord* record) {
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
    ViewDepthCallbacks callbacks;
    callbacks.progress = [&](int done, int count) {
      progress.Update("computing depth", done, count, "frames");
      return CaughtInterrupt() == 0;
    };
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
    fusion.progress = [&](int done, int count) {
      progress.Update("fusing depth", done, count, "views");
    };
    dense = output.WriteDense(
        reconstruction, *system->depth_maps(),
        {.depth = options.saves_depth, .views = options.saves_views, .mesh = options.has_mesh},
        fusion);
    if (!record->failure) record->failure = dense->mesh_failure;
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
                     const System& system) {
  const std::span<const Map> maps = system.maps();
  const auto largest = std::ranges::max_element(maps, {}, &Map::num_keyframes);
  if (largest == maps.end()) return;
  std::optional<KnownGround> ground = system.grounds()[largest - maps.begin()];
  if (ground && ground->is_rough) ground.reset();  // The next run may find it.
  WriteMap(path, {width, file_world_from_map, ground, *largest});
}

/// Completes options that were left open, and refuses what cannot be done, before any work.
RunOptions Settle(RunOptions options) {
  if (options.localizes) options.weights = "none";  // No keyframes are made.
  if (options.weights.empty()) options.weights = nn::DefaultWeights().string();
  for (const auto& [name, is_given] : {std::pair("--save-depth", options.saves_depth),
                                       {"--save-views", options.saves_views},
                                       {"--mesh", options.has_mesh},
                                       {"--cloud-quality", !options.cloud_quality.empty()}}) {
    if (is_given && options.weights == "none") {
      throw UserError(std::string(name) +
                      ": without a network there is no dense depth; leave it out");
    }
  }
  return options;
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
    system.EnableDepth(options.weights, output.folder() / "depth.tmp");
  }
  if (stored) options.localizes ? system.Localize(*stored) : system.LoadMap(*stored);
  stored.reset();
  const auto start = Clock::now();
  RunRecord record = ProcessFrames(sequence.get(), &system, &output, options.is_quiet);
  const auto last_frame = Clock::now();
  const Reconstruction reconstruction = system.Finish();
  record.finishing_seconds = SecondsSince(last_frame);
  record.seconds = SecondsSince(start);
  const std::optional<DenseOutput> dense =
      FuseDepth(reconstruction, options, threads, output, &system, &record);
  const nlohmann::json summary =
      Summarize(reconstruction, record, dense,
                {options.input, options.mask, masked_fraction, options.weights, threads});
  const Rigid3 file_world_from_map = output.Finish(reconstruction, summary, dense);
  if (!options.map_out.empty()) {
    WriteLargestMap(options.map_out, size.width, file_world_from_map, system);
  }
  if (options.saves_sparse && options.weights == "none") {
    WriteSparseKeyframes(MakeSparseFolder(output.folder()), system.maps(),
                         OpenInput(options.input, sequence_options).get());
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
  return EXIT_SUCCESS;
}

}  // namespace

void AddRunCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand("run", "Track a 360-degree video and map what it sees");
  const auto options = std::make_shared<RunOptions>();
  SequenceOptions& sequence = options->sequence;
  command
      ->add_option(
          "INPUT", options->input,
          "Equirectangular video, folder of images, sequence folder, or town:NAME to render a "
          "town (Town1 ... Town5, Loop, a seed) while tracking it")
      ->required();
  command->add_option("--out", options->out, "Folder for the results; created if need be")
      ->required()
      ->type_name("DIR");
  command->add_option("--config", options->config, "Options as `orb360 config` prints them")
      ->type_name("FILE");
  command
      ->add_option("--weights", options->weights,
                   "Network for dense depth and the dense cloud (default: the one "
                   "that comes with orb360); or none, for landmarks alone")
      ->type_name("none|FILE");
  command
      ->add_option("--mask", options->mask,
                   "What to leave out: auto finds what moves with the camera; or none; or an image "
                   "that is black there")
      ->type_name("auto|none|FILE")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads (default: one for each core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command->add_option("--max-frames", sequence.max_frames, "Stop after so many frames")
      ->check(CLI::Range(1, 1 << 30))
      ->type_name("N");
  command
      ->add_option("--fps", sequence.fps,
                   "Frames a second, instead of what the input says (image folders: 30)")
      ->check(CLI::Range(1e-3, 1e6))
      ->check(kIsNumber)
      ->type_name("RATE");
  command->add_option("--stride", sequence.stride, "Use every N-th frame")
      ->check(CLI::Range(1, 1 << 30))
      ->type_name("N");
  command->add_option("--start", sequence.start, "First frame to use, counted from 0")
      ->check(CLI::Range(0, 1 << 30))
      ->type_name("N");
  command
      ->add_option("--camera-height", options->camera_height,
                   "Height of the camera over the ground, metres (default: as the configuration or "
                   "the input says, or 1.6)")
      ->check(CLI::Range(0.01, 100.0))
      ->check(kIsNumber)
      ->type_name("M");
  command->add_option("--resize", options->resize, "Scale every image first")->type_name("WxH");
  CLI::Option* map_in =
      command->add_option("--map-in", options->map_in, "Begin in a map that --map-out has written")
          ->type_name("FILE");
  CLI::Option* map_out = command
                             ->add_option("--map-out", options->map_out,
                                          "Keep the map, the largest of several, for later runs")
                             ->type_name("FILE");
  command
      ->add_flag("--localize", options->localizes,
                 "Only locate the camera in the map; the map stays as it is")
      ->needs(map_in)
      ->excludes(map_out);
  command
      ->add_option("--loops", options->loops,
                   "Recognise places: close loops, join maps, find the camera after a loss")
      ->check(CLI::IsMember({"on", "off"}))
      ->type_name("on|off")
      ->capture_default_str();
  command->add_flag(
      "--save-sparse", options->saves_sparse,
      "Also write to DIR/sparse (HDF5) what the network completes: the image of each view "
      "with points from landmarks and stereo; with --weights none each keyframe with "
      "its landmarks");
  command->add_flag(
      "--save-depth", options->saves_depth,
      "Also write the dense depth of each view to DIR/depth (16-bit PNG, metres * 256)");
  command->add_flag("--save-views", options->saves_views,
                    "Also keep in DIR/views what the dense cloud is made of (about 0.5 MB a "
                    "view), so that `orb360 fuse DIR` can make it again");
  command->add_flag("--mesh", options->has_mesh,
                    "Also write the surface through the dense cloud to DIR/mesh.ply");
  command
      ->add_option("--cloud-quality", options->cloud_quality,
                   "draft: of what the network completes from landmarks; normal: of what stereo "
                   "between frames shows, and the network completes (takes longer); high: from "
                   "images of up to 2048x1024 instead of 1024x512 (takes four times as long)")
      ->check(CLI::IsMember({"draft", "normal", "high"}))
      ->type_name("draft|normal|high")
      ->default_str("normal");
  command->add_flag("--quiet", options->is_quiet, "Show no progress");
  command->callback([options, chosen] { *chosen = [options] { return Run(Settle(*options)); }; });
}

}  // namespace orb360
