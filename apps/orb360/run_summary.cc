#include "apps/orb360/run_summary.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <sys/resource.h>

#include "apps/orb360/interrupt.h"
#include "apps/orb360/run_positions.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/version.h>

namespace orb360 {
namespace {

double PeakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // KiB on Linux
}

nlohmann::json DescribeScale(const MetricScale& scale) {
  nlohmann::json described = {{"state", ToString(scale.state)},
                              {"value", nullptr},
                              {"sigma", nullptr},
                              {"camera_height", nullptr},
                              {"assumed_height", scale.is_height_assumed},
                              {"lens_distance", scale.lens_distance},
                              {"surroundings_rise", scale.surroundings_rise},
                              {"ground_probability", nullptr},
                              {"sources", scale.sources}};
  if (scale.value > 0) {
    described["value"] = scale.value;
    described["sigma"] = scale.sigma;
  }
  if (scale.ground_probability) described["ground_probability"] = *scale.ground_probability;
  if (scale.camera_height > 0) described["camera_height"] = scale.camera_height;
  return described;
}

/// Returns pairs of the frame that came back and the frame of the place.
nlohmann::json FramesOf(const std::vector<ClosedLoop>& loops) {
  nlohmann::json pairs = nlohmann::json::array();
  for (const ClosedLoop& loop : loops) pairs.push_back({loop.frame, loop.place});
  return pairs;
}

/// Returns the same pairs as timestamps, seconds.
nlohmann::json TimesOf(const std::vector<ClosedLoop>& loops, const std::vector<FramePose>& frames) {
  const auto time_of = [&](int index) {
    return std::ranges::lower_bound(frames, index, {}, &FramePose::index)->timestamp;
  };
  nlohmann::json pairs = nlohmann::json::array();
  for (const ClosedLoop& loop : loops) {
    // A place in a loaded map is not a frame of this run.
    if (loop.place < frames.front().index) continue;
    pairs.push_back({time_of(loop.frame), time_of(loop.place)});
  }
  return pairs;
}

/// Returns the times of the frames whose map is another than that of the frame before, seconds.
/// Frames of the run that made a loaded map do not count.
std::vector<double> MapChanges(const std::vector<FramePose>& frames) {
  std::vector<double> times;
  for (size_t i = 1; i < frames.size(); ++i) {
    const bool is_of_run = frames[i - 1].index >= 0;
    if (is_of_run && frames[i].map != frames[i - 1].map) times.push_back(frames[i].timestamp);
  }
  return times;
}

}  // namespace

nlohmann::json Summarize(const Reconstruction& reconstruction, const RunRecord& record,
                         const std::optional<DenseOutput>& dense,
                         const RunDescription& description) {
  nlohmann::json summary = {
      {"version", Version()},
      {"input", description.input},
      {"lens", description.lens},
      {"fps", nullptr},
      {"frames", record.frames},
      {"tracked", reconstruction.frames.size()},
      {"lost", reconstruction.lost},
      {"maps", reconstruction.maps.size()},
      {"map_changes", MapChanges(reconstruction.frames)},
      {"loops", reconstruction.loops.size()},
      {"loop_frames", FramesOf(reconstruction.loops)},
      {"loop_times", TimesOf(reconstruction.loops, reconstruction.frames)},
      {"relocalizations", reconstruction.relocalized},
      {"interpolated", reconstruction.interpolated},
      {"merges", reconstruction.merges.size()},
      {"merge_frames", FramesOf(reconstruction.merges)},
      {"initialized_at", nullptr},
      {"keyframes", reconstruction.keyframes.size()},
      {"landmarks", reconstruction.landmarks.size()},
      {"features_per_keyframe", reconstruction.features_per_keyframe},
      {"landmarks_per_keyframe", reconstruction.landmarks_per_keyframe},
      {"scale", DescribeScale(reconstruction.scale)},
      {"timing_ms", record.times.Summary()},
      {"seconds", record.seconds},
      {"finishing_seconds", record.finishing_seconds},
      {"frames_per_second", record.frames / std::max(record.seconds, 1e-9)},
      {"peak_memory_mb", PeakMemoryMb()},
      {"mask", description.mask},
      {"masked_fraction", description.masked_fraction},
      {"levelled", reconstruction.up.has_value()},
      {"threads", description.threads},
      {"weights", description.weights},
      {"device", description.device},
      {"precision", description.precision},
      {"positions", description.positions},
      {"interrupted", CaughtInterrupt() != 0 || record.failure != nullptr},
      {"warnings", record.warnings},
  };
  if (description.fps) summary["fps"] = *description.fps;
  if (reconstruction.initialized_at) summary["initialized_at"] = *reconstruction.initialized_at;
  if (dense) {
    summary["cloud"] = {{"points", dense->cloud.points},
                        {"views", dense->cloud.fusion.views},
                        {"measured_views", record.depth.measured},
                        {"views_without_sources", record.depth.without_sources},
                        {"views_with_moving_objects", record.depth.with_moving_objects},
                        {"unseen_views", record.depth.unseen},
                        {"voxel_size", dense->cloud.fusion.voxel_size},
                        {"seconds", record.fusion_seconds}};
    if (dense->mesh) {
      summary["mesh"] = {{"vertices", dense->mesh->vertices},
                         {"triangles", dense->mesh->triangles}};
    }
  }
  return summary;
}

RunSummary ReadSummary(const std::filesystem::path& path) {
  try {
    std::ifstream file(path);
    const nlohmann::json json = nlohmann::json::parse(file);
    RunSummary summary;
    summary.input = json.at("input").get<std::string>();
    summary.lens = json.value("lens", "");
    summary.is_levelled = json.value("levelled", false);
    if (json.contains("fps") && !json["fps"].is_null()) summary.fps = json["fps"].get<double>();
    const nlohmann::json scale = json.value("scale", nlohmann::json::object());
    summary.has_unknown_scale = scale.value("state", "") == ToString(ScaleState::kUnknown);
    const nlohmann::json sources = scale.value("sources", nlohmann::json::array());
    const bool has_positions = std::ranges::find(sources, "positions") != sources.end();
    if (!has_positions && scale.contains("value") && !scale["value"].is_null()) {
      summary.scale = {std::log(scale["value"].get<double>()), scale.at("sigma").get<double>()};
    }
    return summary;
  } catch (const nlohmann::json::exception&) {
    throw UserError(path.string() + ": is damaged; run `orb360 run` again");
  }
}

/// Says in one line how far the metres can be relied on, and what would help.
std::string StateScale(const nlohmann::json& scale) {
  std::ostringstream text;
  text << std::fixed << "scale " << scale["state"].get<std::string>();
  if (scale["sources"].empty() && scale["ground_probability"].is_number()) {
    text << std::setprecision(2)
         << ": what is below the camera does not look like ground (probability "
         << scale["ground_probability"].get<double>()
         << "); is it on its side? Lengths have an arbitrary unit (positions would tell it)";
    return text.str();
  }
  if (scale["sources"].empty()) {
    text << ": no ground was seen below the camera; lengths have an arbitrary unit (positions "
            "would tell it)";
    return text.str();
  }
  if (scale["sigma"].is_number()) {
    text << std::setprecision(1) << ": standard deviation " << 100 * scale["sigma"].get<double>()
         << " %";
  }
  std::string separator = ", from ";
  for (const nlohmann::json& source : scale["sources"]) {
    text << std::exchange(separator, " and ") << source.get<std::string>();
  }
  if (scale["camera_height"].is_null()) return text.str();  // Only positions tell the scale.
  const bool is_assumed = scale["assumed_height"];
  text << std::setprecision(2)
       << (is_assumed ? "; an assumed camera height of " : ", camera height ")
       << scale["camera_height"].get<double>() << " m";
  if (is_assumed) text << " (give the true one with --camera-height)";
  return text.str();
}

/// Says why stereo has measured little, if it was to.
std::string StateCloud(const nlohmann::json& summary) {
  if (!summary.contains("cloud")) return {};
  const nlohmann::json& cloud = summary["cloud"];
  const int measured = cloud["measured_views"];
  const int without_sources = cloud["views_without_sources"];
  const int unseen = cloud["unseen_views"];
  if (measured >= without_sources + unseen) return {};
  std::string text = "\ncloud: stereo has measured " + std::to_string(measured) + " of " +
                     std::to_string(measured + without_sources + unseen) + " views";
  if (without_sources > 0) {
    text += "; around " + std::to_string(without_sources) +
            " no frames have a distance at which ranges show";
  }
  if (unseen > 0) text += "; of " + std::to_string(unseen) + " too little has texture";
  return text;
}

void PrintResult(const nlohmann::json& summary, const std::filesystem::path& folder) {
  const nlohmann::json& positions = summary["positions"];
  std::cout << summary["tracked"] << " of " << summary["frames"] << " frames tracked in "
            << summary["maps"] << (summary["maps"] == 1 ? " map, " : " maps, ")
            << summary["keyframes"] << " keyframes, " << summary["landmarks"] << " landmarks, "
            << std::lround(summary["frames_per_second"].get<double>()) << " frames a second\n"
            << StateScale(summary["scale"]) << StateCloud(summary)
            << (positions.is_null() ? "" : "\n" + StatePositions(positions))
            << "\nwrote trajectory.txt, keyframes.txt, scale.txt, cloud.ply, reconstruction.h5, "
               "map.svg, summary.json"
            << (IsPlaced(positions) ? ", georeference.json" : "") << " and report.html to "
            << folder.string() << "\n`orb360 view " << folder.string()
            << "` shows the run in a browser" << std::endl;
}

}  // namespace orb360
