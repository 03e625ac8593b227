#include "apps/orb360/export_options.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "apps/orb360/commands.h"
#include "nn/base/number_text.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// A format, with what it exports unless the user says otherwise.
struct ExportFormat {
  std::string_view name;
  const char* frames;  ///< nullptr: only the cloud.
  const char* views;   ///< nullptr: only a trajectory.
};

constexpr std::array kFormats = {
    ExportFormat{"tum", "all", nullptr},
    ExportFormat{"kitti", "all", nullptr},
    ExportFormat{"euroc", "all", nullptr},
    ExportFormat{"geojson", "all", nullptr},
    ExportFormat{"gpx", "all", nullptr},
    ExportFormat{"kml", "all", nullptr},
    ExportFormat{"colmap", "keyframes", "sphere"},
    ExportFormat{"colmap-rig", "keyframes", "cube"},
    ExportFormat{"nerfstudio", "keyframes", "sphere"},
    ExportFormat{"opensfm", "keyframes", "sphere"},
    ExportFormat{"images", "sharpest", "sphere"},
    ExportFormat{"las", nullptr, nullptr},
    ExportFormat{"mcap", "all", "sphere"},
};

const ExportFormat& FormatOf(const std::string& name) {
  const auto format = std::ranges::find(kFormats, name, &ExportFormat::name);
  if (format != kFormats.end()) return *format;
  std::string known;
  for (const ExportFormat& each : kFormats)
    known += (known.empty() ? "" : ", ") + std::string(each.name);
  throw UserError("--to: there is no format `" + name + "`; there are " + known);
}

}  // namespace

void AddExportOptions(CLI::App* command, ExportOptions* options) {
  command->add_option("RUN", options->run, "Folder of a run")->required()->type_name("DIR");
  command
      ->add_option(
          "--to", options->format,
          "tum, kitti, euroc: the trajectory; geojson, gpx, kml: the same in geographic "
          "coordinates; colmap: a model of panoramas (COLMAP 4.1); "
          "colmap-rig: of a rig of pinhole cameras, for every COLMAP; nerfstudio; opensfm; "
          "images: sharp images for splatting; las: the dense cloud; mcap: messages of ROS 2")
      ->required()
      ->type_name("FORMAT");
  command->add_option("--out", options->out, "Folder for the results; new or empty")
      ->required()
      ->type_name("DIR");
  command->add_option("--input", options->input, "The run's input, where it has been moved")
      ->type_name("INPUT");
  command
      ->add_option("--lens", options->lens,
                   "Calibration of two fisheye lenses (default: that of the run)")
      ->type_name("FILE|PRESET");
  command
      ->add_option("--frames", options->frames,
                   "keyframes; all frames that have a pose; or of these the sharpest ones, "
                   "--spacing apart (default: trajectories all, images sharpest, else keyframes)")
      ->check(CLI::IsMember({"keyframes", "all", "sharpest"}))
      ->type_name("keyframes|all|sharpest");
  command
      ->add_option("--spacing", options->spacing,
                   "Distance between the sharpest frames, as a fraction of the distance of what "
                   "the camera sees")
      ->check(CLI::Range(1e-3, 10.0))
      ->check(kIsNumber)
      ->type_name("S")
      ->capture_default_str();
  command
      ->add_option("--map", options->map,
                   "Which of several maps, counted from 0 (default: the one with most keyframes)")
      ->check(CLI::Range(0, 1 << 30))
      ->type_name("N");
  command
      ->add_option("--images", options->images,
                   "Format of the images, or none to leave them out (default: jpg)")
      ->check(CLI::IsMember({"jpg", "png", "none"}))
      ->type_name("jpg|png|none");
  command
      ->add_option("--views", options->views,
                   "What each frame becomes: sphere, the panorama; cube, six pinhole views; or a "
                   "number of pinhole views around the horizon (default: colmap-rig cube, else "
                   "sphere)")
      ->type_name("sphere|cube|N");
  command
      ->add_option("--fov", options->fov, "Field of view of pinhole views, degrees (default: 96)")
      ->check(CLI::Range(30.0, 130.0))
      ->check(kIsNumber)
      ->type_name("DEG");
  command
      ->add_option("--points", options->points,
                   "landmarks with the images that observe them, or points of the dense cloud, "
                   "which have none (default: landmarks)")
      ->check(CLI::IsMember({"landmarks", "cloud"}))
      ->type_name("landmarks|cloud");
  command
      ->add_option("--max-points", options->max_points,
                   "Largest number of points (default: all landmarks, or 500000 of the cloud)")
      ->check(CLI::Range(1, 100'000'000))
      ->type_name("N");
  command->add_flag("--text", options->is_text, "Write COLMAP's files as text");
  command->add_flag("--quiet", options->is_quiet, "Show no progress");
}

ExportOptions Settle(ExportOptions options) {
  const ExportFormat& format = FormatOf(options.format);
  if (format.frames == nullptr && (!options.frames.empty() || options.map >= 0)) {
    throw UserError((options.frames.empty() ? "--map: " : "--frames: ") + options.format +
                    " is a format of the whole cloud; leave it out");
  }
  if (options.frames.empty() && format.frames != nullptr) options.frames = format.frames;
  for (const auto& [name, is_given] : {std::pair("--images", !options.images.empty()),
                                       {"--views", !options.views.empty()},
                                       {"--fov", options.fov > 0},
                                       {"--points", !options.points.empty()},
                                       {"--max-points", options.max_points > 0},
                                       {"--text", options.is_text}}) {
    if (is_given && format.views == nullptr) {
      throw UserError(std::string(name) + ": " + options.format +
                      (format.frames == nullptr
                           ? " is a format of the whole cloud; leave it out"
                           : " is a format of trajectories alone; leave it out"));
    }
  }
  if (options.is_text && !options.format.starts_with("colmap")) {
    throw UserError("--text: only COLMAP has files of both kinds; leave it out");
  }
  if (options.views.empty() && format.views != nullptr) options.views = format.views;
  const bool has_panoramas_only = options.format == "opensfm" || options.format == "mcap";
  if (has_panoramas_only && options.views != "sphere") {
    throw UserError("--views: " + options.format + " has panoramas only; leave it out");
  }
  if (options.views == "sphere" && options.fov > 0) {
    throw UserError("--fov: a panorama has no field of view; give --views cube or a number");
  }
  if (options.fov == 0) options.fov = 96;
  if (options.images.empty()) options.images = "jpg";
  if (options.images == "none" && options.format == "images") {
    throw UserError("--images: with none there is nothing to export");
  }
  if (options.points.empty()) options.points = "landmarks";
  return options;
}

bool IsGeographic(const std::string& format) {
  return format == "geojson" || format == "gpx" || format == "kml";
}

std::vector<View> ViewsOf(const ExportOptions& options, const SparseModel& model) {
  const double fov = options.fov * std::numbers::pi / 180;
  if (options.views == "sphere") return PanoramaView(model.width, model.height);
  if (options.views == "cube") {
    if (options.fov < 90) {
      throw UserError("--fov: faces of a cube with less than 90 degrees leave gaps");
    }
    return CubeViews(model.width, fov);
  }
  const std::optional<int> count = ParseNumber<int>(options.views);
  if (!count || *count < 1 || *count > 36) {
    throw UserError("--views: `" + options.views +
                    "` is neither sphere nor cube nor a number of views from 1 to 36");
  }
  return RingViews(model.width, *count, fov);
}

}  // namespace orb360
