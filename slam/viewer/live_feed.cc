#include "slam/viewer/live_feed.h"

#include <chrono>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/io/image_file.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

constexpr int kMaxWidth = 1280;  // of images for the page, pixels

/// Each corner once, although it is a feature of several levels of the pyramid.
std::vector<LiveSnapshot::Feature> CopyFeatures(const PresentState& state) {
  const std::vector<int>& corners = state.features.corners;
  std::vector<std::uint8_t> is_matched(corners.size(), 0);  // by corner
  for (size_t i = 0; i < state.landmarks.size(); ++i) {
    if (state.landmarks[i] != kNoId) is_matched[corners[i]] = 1;
  }
  std::vector<LiveSnapshot::Feature> features;
  for (size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] != static_cast<int>(i)) continue;
    features.push_back({state.features.keypoints[i].pixel, is_matched[i] != 0});
  }
  return features;
}

std::string EncodeForPage(const cv::Mat& image) {
  if (image.empty()) return {};
  if (image.cols <= kMaxWidth) return EncodeImage(".jpg", image);
  cv::Mat small;
  cv::resize(image, small, {kMaxWidth, image.rows * kMaxWidth / image.cols}, 0, 0, cv::INTER_AREA);
  return EncodeImage(".jpg", small);
}

}  // namespace

void LiveFeed::Take(const PresentState& state) {
  if (state.map_from_camera && map_number_ != state.map_number) {
    first_pose_ = state.map_from_camera;
    map_number_ = state.map_number;
  }
  // The map is at home after few frames only, so a copy without one waits for the next.
  if (!is_wanted_) return;
  LiveSnapshot snapshot;
  snapshot.frame = state.frame.index;
  snapshot.timestamp = state.frame.timestamp;
  snapshot.state = state.state;
  snapshot.map_number = state.map_number;
  snapshot.image = state.frame.image.clone();
  snapshot.features = CopyFeatures(state);
  snapshot.map_from_camera = state.map_from_camera;
  snapshot.ground = state.ground;
  snapshot.loops.assign(state.loops.begin(), state.loops.end());
  if (first_pose_) {
    snapshot.world_from_map = FileWorldFromMap(
        *first_pose_, state.ground ? std::optional(state.ground->up) : std::nullopt);
  }
  if (state.map != nullptr) snapshot.map = CopyMap(*state.map);
  const std::lock_guard lock(mutex_);
  const int revision = latest_ ? latest_->revision : 0;
  snapshot.revision = revision;
  if (state.map != nullptr) {
    snapshot.revision = revision + 1;
    is_wanted_ = false;
  } else if (latest_) {
    snapshot.map = std::move(latest_->map);
  }
  latest_ = std::move(snapshot);
}

bool LiveFeed::WaitForTurn(const std::function<bool()>& is_ended) {
  constexpr std::chrono::milliseconds kStep(50);  // after which `is_ended` is asked again
  std::unique_lock lock(mutex_);
  while (is_paused_ && steps_ == 0 && !is_finishing_ && !is_ended()) changed_.wait_for(lock, kStep);
  if (steps_ > 0) --steps_;
  return !is_finishing_;
}

ResourceTable LiveFeed::Resources() {
  const auto copy = [this] {
    const std::lock_guard lock(mutex_);
    return latest_.value_or(LiveSnapshot());
  };
  const auto action = [this](auto change) {
    return [this, change] {
      {
        const std::lock_guard lock(mutex_);
        change();
      }
      is_wanted_ = true;
      changed_.notify_all();
      return std::string("done\n");
    };
  };
  ResourceTable table;
  table["live.json"] = {"application/json", {}, [this, copy] {
                          const LiveSnapshot snapshot = copy();
                          is_wanted_ = true;
                          const std::lock_guard lock(mutex_);
                          return LiveJson(snapshot, is_paused_);
                        }};
  table["live.points"] = {"application/octet-stream", {}, [copy] { return LivePoints(copy()); }};
  table["live.jpg"] = {"image/jpeg", {}, [copy] { return EncodeForPage(copy().image); }};
  const std::string text = "text/plain; charset=utf-8";
  table["pause"] = {text, {}, action([this] { is_paused_ = true; }), true};
  table["resume"] = {text, {}, action([this] { is_paused_ = false; }), true};
  table["step"] = {text,
                   {},
                   action([this] {
                     is_paused_ = true;
                     ++steps_;
                   }),
                   true};
  table["finish"] = {text, {}, action([this] { is_finishing_ = true; }), true};
  return table;
}

}  // namespace orb360
