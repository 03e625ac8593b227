#include "apps/orb360/run_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "slam/evaluation/chart.h"
#include "slam/evaluation/html_report.h"
#include "slam/io/atomic_file.h"
#include "slam/io/output_file.h"
#include "slam/viewer/run_scene.h"

namespace orb360 {
namespace {

/// Returns 1234567 as "1,234,567".
std::string Grouped(double value) {
  const std::string digits = Decimal(value, 0);
  std::string text;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string WithUnit(double value, int decimals, const char* unit) {
  std::string text = Decimal(value, decimals);
  text += ' ';
  text += unit;
  return text;
}

/// Returns the length of the path along the frames. Steps from one map to the next do not count.
double PathLength(const std::vector<FramePose>& frames) {
  double length = 0;
  for (size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].map != frames[i - 1].map) continue;
    length +=
        (frames[i].world_from_camera.translation - frames[i - 1].world_from_camera.translation)
            .norm();
  }
  return length;
}

std::vector<HtmlReport::Tile> MakeTiles(const Reconstruction& reconstruction,
                                        const nlohmann::json& summary) {
  const double frames = std::max(summary.value("frames", 0.0), 1.0);
  const std::string frames_text = Grouped(summary.value("frames", 0.0));
  const bool has_metres = HasMetres(summary);
  std::vector<HtmlReport::Tile> tiles = {
      {WithUnit(100.0 * summary.value("tracked", 0.0) / frames, 1, "%"),
       "of the " + frames_text + " frames tracked"},
      {Grouped(summary.value("lost", 0.0)), "times lost"},
      {Decimal(PathLength(reconstruction.frames), 1) + (has_metres ? " m" : ""),
       has_metres ? "path" : "path, in units of the map"},
      {Grouped(summary.value("keyframes", 0.0)), "keyframes"},
      {Grouped(summary.value("landmarks", 0.0)), "landmarks"},
      {Decimal(summary.value("features_per_keyframe", 0.0), 0), "features matched in a keyframe"},
      {Decimal(summary.value("frames_per_second", 0.0), 1), "frames a second"},
      {WithUnit(summary.value("peak_memory_mb", 0.0), 0, "MB"), "memory at most"},
  };
  if (summary.contains("cloud")) {
    tiles.push_back({Grouped(summary["cloud"].value("points", 0.0)), "points in the cloud"});
  }
  if (has_metres) {
    const nlohmann::json& scale = summary["scale"];
    const bool is_assumed = scale.value("assumed_height", true);
    tiles.push_back(
        {WithUnit(100.0 * scale.value("sigma", 0.0), 1, "%"), "standard deviation of the metres"});
    const auto height = scale.find("camera_height");
    if (height != scale.end() && height->is_number()) {  // Positions alone tell none.
      tiles.push_back({WithUnit(height->get<double>(), 2, "m"),
                       is_assumed ? "assumed camera height" : "camera height"});
    }
  }
  return tiles;
}

std::vector<HtmlReport::Bar> MakeBars(const nlohmann::json& summary) {
  std::vector<HtmlReport::Bar> bars;
  if (!summary.contains("timing_ms")) return bars;
  for (const auto& [stage, times] : summary["timing_ms"].items()) {
    bars.push_back({stage, times.value("median", 0.0), times.value("p95", 0.0)});
  }
  std::ranges::stable_sort(bars, std::ranges::greater(), &HtmlReport::Bar::value);
  return bars;
}

std::string ViewName(int frame_index) {
  char name[32];
  std::snprintf(name, sizeof name, "depth_%06d.png", frame_index);
  return name;
}

}  // namespace

void WriteRunReport(const std::filesystem::path& run_folder, const Reconstruction& reconstruction,
                    const nlohmann::json& summary, const std::string& map_svg,
                    const DenseImages& images) {
  const std::filesystem::path folder = run_folder / "report";
  std::error_code error;
  std::filesystem::remove_all(folder, error);  // Images of an earlier run.
  if (!error) std::filesystem::create_directories(folder, error);
  if (error) ThrowWriteError(folder, error.value());

  HtmlReport report;
  report.title = summary.value("input", "");
  report.subtitle = "orb360 ";
  report.subtitle += summary.value("version", "");
  if (summary.value("interrupted", false)) report.subtitle += ", ended early";
  report.tiles = MakeTiles(reconstruction, summary);
  if (summary.contains("warnings")) {
    report.warnings = summary["warnings"].get<std::vector<std::string>>();
  }
  const auto add_png = [&](const std::string& name, const cv::Mat& image, const std::string& title,
                           const std::string& caption) {
    const std::string png = EncodePng(image);
    WriteFileAtomically(folder / name, png);
    report.images.push_back({title, caption, png, "image/png"});
  };
  if (!images.cloud.empty()) {
    add_png("cloud.png", images.cloud, "The cloud from above",
            "Cut off at the height of the camera, so that ceilings and trees hide nothing. The "
            "line is the camera's path, the ring its beginning. The points are in cloud.ply.");
  }
  if (!map_svg.empty()) {
    report.images.push_back(
        {"Trajectory and map from above",
         "Keyframes (blue), landmarks (grey), and which keyframes see the same landmarks (green).",
         map_svg, "image/svg+xml"});
  }
  for (const DenseImages::OfView& view : images.views) {
    add_png(ViewName(view.frame_index), view.image,
            "Depth of frame " + std::to_string(view.frame_index),
            "The image, its range (red is near, blue is far) and its confidence (white is "
            "certain).");
  }
  report.bars_title = "Time of a frame by stage";
  report.bars_unit = "Milliseconds: median and 95th percentile. Stages may overlap.";
  report.bars = MakeBars(summary);
  report.table_title = "Files of this run";
  report.table = {
      {"trajectory.txt", "pose of every tracked frame, TUM format, world from camera"},
      {"keyframes.txt", "the same of the keyframes"},
      {"scale.txt", "scale along the path, with its standard deviation"},
      {"cloud.ply", "points with colour, for any viewer of point clouds"},
      {"map.svg", "the map above, as a file"},
      {"summary.json", "all figures"},
  };
  WriteFileAtomically(folder / "report.html", MakeHtml(report));
}

}  // namespace orb360
