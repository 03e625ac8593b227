#include "slam/viewer/live_snapshot.h"

#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/io/byte_number.h"
#include "slam/io/image_file.h"
#include "slam/io/optical_frame.h"
#include "slam/map/covisibility.h"

namespace orb360 {
namespace {

constexpr int kMinShared = 15;  // landmarks, as in the finished keyframe graph
// Of images for the page, which are encoded on a processor that the run needs:
constexpr int kMaxWidth = 1280;  // pixels
constexpr int kJpegQuality = 80;

const char* NameOf(TrackingState state) {
  switch (state) {
    case TrackingState::kInitializing:
      return "initializing";
    case TrackingState::kTracking:
      return "tracking";
    case TrackingState::kLost:
      return "lost";
  }
  return "lost";
}

/// x y z qx qy qz qw of the optical camera frame.
nlohmann::json PoseJson(const Rigid3& world_from_camera) {
  constexpr double kSteps = 1e5;  // in a unit of length
  const Rigid3 pose = WorldFromOptical(world_from_camera);
  nlohmann::json json = nlohmann::json::array();
  for (const double value : pose.translation) json.push_back(std::round(value * kSteps) / kSteps);
  for (const double value : pose.rotation.coeffs()) {
    json.push_back(std::round(value * kSteps) / kSteps);
  }
  return json;
}

std::string EncodeForPage(const std::string& extension, const cv::Mat& image) {
  if (image.empty()) return {};
  if (image.cols <= kMaxWidth) return EncodeImage(extension, image, kJpegQuality);
  cv::Mat small;
  cv::resize(image, small, {kMaxWidth, image.rows * kMaxWidth / image.cols}, 0, 0, cv::INTER_AREA);
  return EncodeImage(extension, small, kJpegQuality);
}

}  // namespace

LiveSnapshot::MapPart CopyMaps(std::span<const Map> maps, int revision,
                               const LandmarkGroups& before) {
  LiveSnapshot::MapPart part;
  KeyframeId offset = 0;
  for (const Map& map : maps) {
    for (const KeyframeId id : map.KeyframeIds()) {
      const Keyframe& keyframe = map.keyframe(id);
      part.keyframes.push_back({offset + id, keyframe.frame_index, keyframe.world_from_camera});
    }
    for (const CovisibilityEdge& edge : FindCovisibilityEdges(map, kMinShared)) {
      part.links.push_back({offset + edge.first, offset + edge.second});
    }
    offset += map.keyframe_end();
  }
  part.landmarks = GroupLandmarks(maps, revision, before);
  return part;
}

std::string LiveJson(const LiveSnapshot& snapshot, const LiveControl& control, size_t num_views,
                     std::uint64_t since) {
  const cv::Size size = snapshot.image.size();
  nlohmann::json loops = nlohmann::json::array();
  for (const ClosedLoop& loop : snapshot.loops) loops.push_back({loop.frame, loop.place});
  const std::chrono::duration<double, std::milli> age =
      std::chrono::steady_clock::now() - snapshot.taken;
  nlohmann::json json = {{"frame", snapshot.frame},
                         {"age", age.count()},
                         {"time", snapshot.timestamp},
                         {"state", control.is_finishing ? "finishing" : NameOf(snapshot.state)},
                         {"progress", nullptr},
                         {"isPaused", control.is_paused},
                         {"isWaiting", control.is_waiting},
                         {"isMasked", control.is_masked},
                         {"times", nlohmann::json::object()},
                         {"map", snapshot.map_number},
                         {"revision", snapshot.revision},
                         {"size", {size.width, size.height}},
                         {"pose", nullptr},
                         {"keyframes", nullptr},
                         {"links", nullptr},
                         {"loops", loops},
                         {"cameraHeight", nullptr},
                         {"landmarks", CountLandmarks(snapshot.map->landmarks)},
                         {"views", num_views}};
  if (static_cast<std::uint64_t>(snapshot.revision) != since || since == 0) {
    nlohmann::json keyframes = nlohmann::json::array();
    for (const LiveSnapshot::Keyframe& keyframe : snapshot.map->keyframes) {
      nlohmann::json entry = {keyframe.id, keyframe.frame};
      for (nlohmann::json& value : PoseJson(snapshot.world_from_map * keyframe.map_from_camera)) {
        entry.push_back(value);
      }
      keyframes.push_back(entry);
    }
    json["keyframes"] = keyframes;
    json["links"] = snapshot.map->links;
  }
  for (const auto& [stage, time] : control.times) {
    json["times"][stage] = {{"median", time[0]}, {"p95", time[1]}};
  }
  if (const auto& progress = control.progress) {
    json["progress"] = {{"what", progress->what},
                        {"done", progress->done},
                        {"count", progress->count},
                        {"ofWhat", progress->of_what}};
  }
  if (snapshot.map_from_camera) {
    json["pose"] = PoseJson(snapshot.world_from_map * *snapshot.map_from_camera);
  }
  if (snapshot.ground) json["cameraHeight"] = snapshot.ground->camera_height;
  return json.dump();
}

std::string LiveImage(const LiveSnapshot& snapshot) {
  constexpr float kSteps = 10000;
  const auto code = [](float pixel, int size) {
    return static_cast<std::uint16_t>(std::lround(kSteps * pixel / static_cast<float>(size)));
  };
  std::string bytes;
  AppendLittleEndian(static_cast<std::uint32_t>(snapshot.frame), &bytes);
  AppendLittleEndian(static_cast<std::uint32_t>(snapshot.features.size()), &bytes);
  for (const LiveSnapshot::Feature& feature : snapshot.features) {
    AppendLittleEndian(code(feature.pixel.x(), snapshot.image.cols), &bytes);
    AppendLittleEndian(code(feature.pixel.y(), snapshot.image.rows), &bytes);
    AppendLittleEndian(static_cast<std::uint16_t>(feature.is_matched ? 1 : 0), &bytes);
  }
  return bytes + EncodeForPage(".jpg", snapshot.image);
}

std::string LiveMask(const cv::Mat& mask) { return EncodeForPage(".png", mask); }

}  // namespace orb360
