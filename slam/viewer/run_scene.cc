#include "slam/viewer/run_scene.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace orb360 {
namespace {

constexpr int kMinShared = 15;     // landmarks: fewer tell little of how two keyframes lie
constexpr size_t kMaxLinks = 8;    // of a keyframe: more would be a ball of lines
constexpr double kDecimals = 1e5;  // steps in a unit of length, a second, or a quaternion's length

double Rounded(double value) { return std::round(value * kDecimals) / kDecimals; }

/// Place of the frame whose time is nearest. Contract: there is one.
size_t NearestFrame(const std::vector<PosedFrame>& frames, double time) {
  const auto nearest = std::ranges::min_element(
      frames, {}, [time](const PosedFrame& frame) { return std::abs(frame.timestamp - time); });
  return static_cast<size_t>(nearest - frames.begin());
}

nlohmann::json DescribeFrames(const std::vector<PosedFrame>& frames) {
  nlohmann::json json = {{"index", nlohmann::json::array()},
                         {"time", nlohmann::json::array()},
                         {"map", nlohmann::json::array()},
                         {"position", nlohmann::json::array()},
                         {"orientation", nlohmann::json::array()}};
  for (const PosedFrame& frame : frames) {
    json["index"].push_back(frame.index);
    json["time"].push_back(Rounded(frame.timestamp));
    json["map"].push_back(frame.map);
    const Rigid3& pose = frame.world_from_optical;
    for (const double value : pose.translation) json["position"].push_back(Rounded(value));
    for (const double value : pose.rotation.coeffs()) {
      json["orientation"].push_back(Rounded(value));
    }
  }
  return json;
}

/// The pairs of numbers in a list of the summary; what is no such pair is left out.
std::vector<std::pair<double, double>> PairsIn(const nlohmann::json& summary, const char* key) {
  std::vector<std::pair<double, double>> pairs;
  const nlohmann::json list = summary.value(key, nlohmann::json::array());
  if (!list.is_array()) return pairs;
  for (const nlohmann::json& pair : list) {
    if (pair.is_array() && pair.size() == 2 && pair[0].is_number() && pair[1].is_number()) {
      pairs.emplace_back(pair[0].get<double>(), pair[1].get<double>());
    }
  }
  return pairs;
}

/// The loops, by their times, which older runs state as well, and the merges of maps, by the
/// indices of their frames.
nlohmann::json DescribeLoops(const RunScene& scene) {
  nlohmann::json loops = nlohmann::json::array();
  const std::vector<PosedFrame>& frames = scene.model.frames;
  if (frames.empty()) return loops;
  for (const auto& [time, place] : PairsIn(scene.summary, "loop_times")) {
    loops.push_back({NearestFrame(frames, time), NearestFrame(frames, place)});
  }
  const auto find = [&frames](double index) {
    return std::ranges::find(frames, static_cast<int>(index), &PosedFrame::index) - frames.begin();
  };
  for (const auto& [index, place] : PairsIn(scene.summary, "merge_frames")) {
    const auto [from, to] = std::pair(find(index), find(place));
    const auto end = static_cast<long>(frames.size());
    if (from < end && to < end) loops.push_back({from, to});
  }
  return loops;
}

}  // namespace

bool HasMetres(const nlohmann::json& summary) {
  const nlohmann::json scale = summary.value("scale", nlohmann::json::object());
  return scale.is_object() && scale.value("state", "unknown") != "unknown";
}

std::vector<KeyframeLink> LinkKeyframes(const SparseModel& model) {
  std::vector<const PosedFrame*> keyframes;
  for (const PosedFrame& frame : model.frames) {
    if (frame.is_keyframe) keyframes.push_back(&frame);
  }
  std::vector<std::vector<int>> observers(model.points.size());  // keyframes by landmark
  for (size_t k = 0; k < keyframes.size(); ++k) {
    for (const PointObservation& seen : keyframes[k]->observations) {
      observers[seen.point].push_back(static_cast<int>(k));
    }
  }
  std::set<std::pair<int, int>> chosen;
  std::vector<KeyframeLink> links;
  for (size_t k = 0; k < keyframes.size(); ++k) {
    std::vector<int> shared(keyframes.size(), 0);
    for (const PointObservation& seen : keyframes[k]->observations) {
      for (const int other : observers[seen.point]) ++shared[other];
    }
    std::vector<std::pair<int, int>> others;  // negative number of landmarks, keyframe
    for (size_t other = 0; other < shared.size(); ++other) {
      if (other != k && shared[other] >= kMinShared) {
        others.emplace_back(-shared[other], static_cast<int>(other));
      }
    }
    const auto end = others.begin() + static_cast<long>(std::min(kMaxLinks, others.size()));
    std::partial_sort(others.begin(), end, others.end());
    for (auto it = others.begin(); it != end; ++it) {
      const int first = std::min(static_cast<int>(k), it->second);
      const int second = std::max(static_cast<int>(k), it->second);
      if (chosen.emplace(first, second).second) links.push_back({first, second, -it->first});
    }
  }
  std::ranges::sort(links, {},
                    [](const KeyframeLink& link) { return std::pair(link.first, link.second); });
  return links;
}

std::string SceneJson(const RunScene& scene) {
  nlohmann::json keyframes = nlohmann::json::array();
  for (size_t i = 0; i < scene.model.frames.size(); ++i) {
    if (scene.model.frames[i].is_keyframe) keyframes.push_back(i);
  }
  nlohmann::json links = nlohmann::json::array();
  for (const KeyframeLink& link : LinkKeyframes(scene.model)) {
    for (const int value : {link.first, link.second, link.shared}) links.push_back(value);
  }
  nlohmann::json scale = {{"time", nlohmann::json::array()},
                          {"value", nlohmann::json::array()},
                          {"sigma", nlohmann::json::array()}};
  for (const StampedScale& stamped : scene.scales) {
    scale["time"].push_back(Rounded(stamped.timestamp));
    scale["value"].push_back(Rounded(stamped.value));
    scale["sigma"].push_back(Rounded(stamped.sigma));
  }
  const nlohmann::json voxel_size = scene.voxel_size ? nlohmann::json(*scene.voxel_size) : nullptr;
  nlohmann::json comparison;
  if (scene.comparison) {
    comparison = ComparisonJson(*scene.comparison);
    comparison["hasCloud"] = scene.has_other_cloud;
  }
  const nlohmann::json json = {{"folder", scene.folder},
                               {"summary", scene.summary},
                               {"unit", HasMetres(scene.summary) ? "m" : "units"},
                               {"hasCloud", scene.has_cloud},
                               {"voxelSize", voxel_size},
                               {"frames", DescribeFrames(scene.model.frames)},
                               {"keyframes", keyframes},
                               {"links", links},
                               {"loops", DescribeLoops(scene)},
                               {"scale", scale},
                               {"comparison", comparison},
                               {"images", scene.images},
                               {"views", scene.views},
                               {"missing", scene.missing}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace orb360
