#include "apps/orb360/run_options.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "apps/orb360/commands.h"
#include "nn/base/number_text.h"
#include "slam/io/full_sphere.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/models/default_weights.h>

namespace orb360 {

void AddRunOptions(CLI::App* command, RunOptions* options) {
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
  AddDeviceOptions(command, &options->device);
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
  command
      ->add_option("--lens", sequence.lens,
                   "Calibration of two fisheye lenses, which are stitched: a file, or a preset "
                   "(dji-osmo360, gopro-fusion, insta360, insta360-side-by-side, ricoh-theta, "
                   "samsung-gear360)")
      ->type_name("FILE|PRESET");
  command
      ->add_option("--positions", options->positions.file,
                   "Where the camera was: a GPX file, or a video or images with positions; they "
                   "tell the scale and place the result on Earth (default: what INPUT carries)")
      ->type_name("none|FILE");
  AddUtcStartOption(command, &options->positions);
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
      "Also write the dense depth of each view to DIR/depth (16-bit PNG, metres * 256), "
      "how sure it is to DIR/confidence (16-bit PNG) and how it is known to DIR/source");
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
  command
      ->add_flag("--view{8360}", options->view_port,
                 "Show the run in a browser while it goes on: --view, or --view=PORT (0: any that "
                 "is free)")
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
  command
      ->add_option("--view-address", options->view_address,
                   "Address at which --view listens; see orb360 view")
      ->type_name("ADDR")
      ->capture_default_str();
  command->add_flag("--quiet", options->is_quiet, "Show no progress");
}

RunOptions Settle(RunOptions options) {
  if (options.localizes) options.weights = "none";  // No keyframes are made.
  if (options.weights.empty()) options.weights = nn::DefaultWeights().string();
  for (const auto& [name, is_given] : {std::pair("--save-depth", options.saves_depth),
                                       {"--save-views", options.saves_views},
                                       {"--mesh", options.has_mesh},
                                       {"--device", options.device.name != "cpu"},
                                       {"--cloud-quality", !options.cloud_quality.empty()}}) {
    if (is_given && options.weights == "none") {
      throw UserError(std::string(name) +
                      ": without a network there is no dense depth; leave it out");
    }
  }
  return options;
}

cv::Size ParseSize(const std::string& text) {
  if (text.empty()) return {};
  const size_t x = std::min(text.find('x'), text.size() - 1);
  const std::optional<int> width = ParseNumber<int>(std::string_view(text).substr(0, x));
  const std::optional<int> height = ParseNumber<int>(std::string_view(text).substr(x + 1));
  if (width && height && IsFullSphere({*width, *height})) return {*width, *height};
  throw UserError("--resize: `" + text +
                  "` is not WIDTHxHEIGHT with a width of twice the height, such as 2048x1024");
}

}  // namespace orb360
