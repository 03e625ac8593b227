#include "slam/viewer/live_feed.h"

#include <chrono>
#include <utility>
#include <vector>

#include "nn/base/statistics.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

constexpr size_t kNumTimes = 300;  // frames whose times are shown
constexpr int kMapInterval = 100;  // least time from copy to copy of the map, in terms of its own

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

bool IsSame(const Rigid3& a, const Rigid3& b) {
  return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
}

}  // namespace

void LiveFeed::Take(const PresentState& state) {
  if (state.map_from_camera && map_number_ != state.map_number) {
    first_pose_ = state.map_from_camera;
    map_number_ = state.map_number;
  }
  // The map is at home after few frames only, so a copy without one waits for the next.
  if (!is_wanted_) return;
  const std::shared_ptr<const LiveSnapshot> before = Latest();
  auto snapshot = std::make_shared<LiveSnapshot>();
  snapshot->frame = state.frame.index;
  snapshot->timestamp = state.frame.timestamp;
  snapshot->state = state.state;
  snapshot->map_number = state.map_number;
  snapshot->image = state.frame.image.clone();
  snapshot->features = CopyFeatures(state);
  snapshot->map_from_camera = state.map_from_camera;
  snapshot->ground = state.ground;
  snapshot->loops.assign(state.loops.begin(), state.loops.end());
  if (first_pose_) {
    snapshot->world_from_map = FileWorldFromMap(
        *first_pose_, state.ground ? std::optional(state.ground->up) : std::nullopt);
  }
  snapshot->map = before->map;
  snapshot->revision = before->revision;
  if (before->revision > 0 && !IsSame(snapshot->world_from_map, before->world_from_map)) {
    ++snapshot->revision;
  }
  const Clock::time_point begin = now_();
  if (state.map != nullptr && begin >= next_map_) {
    snapshot->map = std::make_shared<LiveSnapshot::MapPart>(
        CopyMaps({state.map, 1}, ++snapshot->revision, before->map->landmarks));
    const Clock::time_point end = now_();
    next_map_ = end + kMapInterval * (end - begin);
  }
  // Where the map is not at home, the next frame is copied as well.
  if (state.map != nullptr) is_wanted_ = false;
  const std::lock_guard lock(mutex_);
  latest_ = std::move(snapshot);
}

void LiveFeed::SetMask(const cv::Mat& mask) {
  const std::lock_guard lock(mutex_);
  mask_ = mask.clone();
  control_.is_masked = !mask.empty();
}

void LiveFeed::AddTimes(const std::map<std::string, double>& timing_ms) {
  const std::lock_guard lock(mutex_);
  for (const auto& [stage, time] : timing_ms) {
    std::deque<double>& times = times_[stage];
    times.push_back(time);
    if (times.size() > kNumTimes) times.pop_front();
  }
}

bool LiveFeed::WaitForTurn(const std::function<bool()>& is_ended) {
  constexpr std::chrono::milliseconds kStep(50);  // after which `is_ended` is asked again
  std::unique_lock lock(mutex_);
  while (control_.is_paused && steps_ == 0 && !control_.is_finishing && !is_ended()) {
    control_.is_waiting = true;
    changed_.wait_for(lock, kStep);
  }
  control_.is_waiting = false;
  if (steps_ > 0) --steps_;
  return !control_.is_finishing;
}

void LiveFeed::End() {
  const std::lock_guard lock(mutex_);
  control_.is_finishing = true;
}

void LiveFeed::ShowFinished(std::span<const Map> maps, const Rigid3& world_from_map) {
  auto snapshot = std::make_shared<LiveSnapshot>(*Latest());
  const LandmarkGroups before = snapshot->map->landmarks;
  snapshot->map =
      std::make_shared<LiveSnapshot::MapPart>(CopyMaps(maps, ++snapshot->revision, before));
  snapshot->world_from_map = world_from_map;
  snapshot->taken = Clock::now();
  snapshot->map_from_camera.reset();  // It was tracked in the map as it was then.
  const std::lock_guard lock(mutex_);
  latest_ = std::move(snapshot);
}

void LiveFeed::ShowProgress(const LiveControl::Progress& progress) {
  const std::lock_guard lock(mutex_);
  control_.progress = progress;
}

void LiveFeed::AddView(int frame, const Rigid3& map_from_camera, const DenseDepth& depth) {
  cloud_.Add(frame, Latest()->world_from_map * map_from_camera, depth);
}

std::shared_ptr<const LiveSnapshot> LiveFeed::Latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

std::string LiveFeed::StateSince(std::uint64_t since) {
  std::shared_ptr<const LiveSnapshot> snapshot;
  LiveControl control;
  std::map<std::string, std::vector<double>> times;
  {
    const std::lock_guard lock(mutex_);
    snapshot = latest_;
    control = control_;
    // A step that the run has not yet begun is no waiting.
    control.is_waiting = control.is_waiting && steps_ == 0;
    for (const auto& [stage, last] : times_) times[stage].assign(last.begin(), last.end());
  }
  for (auto& [stage, values] : times) {
    control.times[stage] = {NearestRankQuantile(values, 0.5), NearestRankQuantile(values, 0.95)};
  }
  is_wanted_ = true;
  return LiveJson(*snapshot, control, cloud_.num_views(), since);
}

ResourceTable LiveFeed::Resources() {
  const auto action = [this](auto change) {
    return [this, change] {
      is_wanted_ = true;  // by the time that the change shows
      {
        const std::lock_guard lock(mutex_);
        change();
      }
      changed_.notify_all();
      return std::string("done\n");
    };
  };
  ResourceTable table;
  const auto since = [&table](const std::string& path, std::string type, auto make) {
    Resource& resource = table[path];
    resource.type = std::move(type);
    resource.make_since = make;
  };
  const std::string bytes = "application/octet-stream";
  since("live.json", "application/json", [this](std::uint64_t r) { return StateSince(r); });
  since("live.points", bytes, [this](std::uint64_t revision) {
    const std::shared_ptr<const LiveSnapshot> snapshot = Latest();
    return LivePoints(snapshot->map->landmarks, snapshot->revision, revision);
  });
  since("live.cloud", bytes, [this](std::uint64_t views) { return cloud_.Bytes(views); });
  table["live.image"] = {bytes, {}, [this] { return LiveImage(*Latest()); }};
  table["live.mask"] = {"image/png", {}, [this] {
                          cv::Mat mask;  // the same pixels, which never change
                          {
                            const std::lock_guard lock(mutex_);
                            mask = mask_;
                          }
                          return LiveMask(mask);
                        }};
  const std::string text = "text/plain; charset=utf-8";
  table["pause"] = {text, {}, action([this] { control_.is_paused = true; }), true};
  table["resume"] = {text, {}, action([this] { control_.is_paused = false; }), true};
  table["step"] = {text,
                   {},
                   action([this] {
                     control_.is_paused = true;
                     ++steps_;
                   }),
                   true};
  table["finish"] = {text, {}, action([this] { control_.is_finishing = true; }), true};
  return table;
}

}  // namespace orb360
