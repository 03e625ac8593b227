#include "slam/pipeline/dense_mapper.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include <opencv2/imgproc.hpp>

#include "slam/pipeline/dense_views.h"
#include "slam/pipeline/keyframe_depth.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

DenseMapper::DenseMapper(const std::filesystem::path& weights, const std::filesystem::path& folder,
                         const DepthOptions& options, int num_threads)
    : options_(options),
      num_threads_(num_threads),
      depth_maps_(folder),
      images_(folder / "images"),
      completer_(weights, {.size = {2 * options.height, options.height}, .threads = num_threads}),
      completion_(&completer_, options) {}

void DenseMapper::KeepImage(int frame_index, const cv::Mat& image, const Rigid3& world_from_camera,
                            double median_range) {
  // A sixth of the nearest source view's distance (KeyframeDepthOptions::baselines).
  constexpr double kMinMotion = 0.02;
  const Eigen::Vector3d& place = world_from_camera.translation;
  const bool is_first = !last_place_ || !unplaced_.empty();
  unplaced_.clear();
  if (!is_first &&
      (!options_.stereo || (place - *last_place_).norm() < kMinMotion * median_range)) {
    return;
  }
  last_place_ = place;
  Keep(frame_index, image);
}

void DenseMapper::KeepKeyframe(int frame_index, const cv::Mat& image) {
  keyframes_.push_back(frame_index);
  Keep(frame_index, image);
}

void DenseMapper::KeepUnplaced(int frame_index, const cv::Mat& image) {
  constexpr size_t kMax = 100;
  Keep(frame_index, image);
  unplaced_.push_back(frame_index);
  if (unplaced_.size() <= kMax + 1) return;
  // The first one may be the reference of the next map's beginning.
  images_.Remove(unplaced_[1]);
  unplaced_.erase(unplaced_.begin() + 1);
}

void DenseMapper::Keep(int frame_index, const cv::Mat& image) {
  if (last_frame_ == frame_index) return;
  AwaitImage();
  if (failure_) return;
  last_frame_ = frame_index;
  cv::Mat small;
  cv::resize(image, small, {camera().width(), camera().height()}, 0, 0, cv::INTER_AREA);
  // cv::resize returns the image of the caller itself where the sizes are equal.
  if (small.data == image.data) small = image.clone();
  keeping_ = std::async(std::launch::async,
                        [this, frame_index, small] { images_.Put(frame_index, small); });
}

// On a full disk only the dense cloud is lost, not the trajectory, which needs the room.
void DenseMapper::AwaitImage() {
  if (!keeping_.valid()) return;
  try {
    keeping_.get();
  } catch (const UserError&) {
    failure_ = std::current_exception();
    images_.Clear();
  }
}

void DenseMapper::Flush() {
  AwaitImage();
  completion_.Drop();
}

KeyframeDepthReport DenseMapper::ComputeDepth(const Reconstruction& finished,
                                              std::span<const Map> maps,
                                              const KeyframeProgress& progress) {
  if (failure_) return {};
  std::vector<std::map<int, KeyframeId>> id_of(maps.size());  // by frame index
  std::set<int> wanted;
  for (size_t m = 0; m < maps.size(); ++m) {
    for (const KeyframeId id : maps[m].KeyframeIds()) {
      const int frame_index = maps[m].keyframe(id).frame_index;
      id_of[m][frame_index] = id;
      // Ids change where maps are merged. The first keyframes of a map are kept by no KeepKeyframe.
      const bool is_wanted =
          options_.every_keyframes == 1 || std::ranges::binary_search(keyframes_, frame_index);
      if (is_wanted && images_.Contains(frame_index)) wanted.insert(frame_index);
    }
  }
  const std::vector<DenseView> views =
      MakeDenseViews(finished, Rigid3(), [&wanted](int index) { return wanted.contains(index); });
  std::vector<FramePose> frames;
  if (options_.stereo) {
    std::ranges::copy_if(finished.frames, std::back_inserter(frames),
                         [this](const FramePose& frame) { return images_.Contains(frame.index); });
  }
  const auto landmarks_of = [&](const DenseView& view) {
    return ProjectLandmarks(maps[view.map], id_of[view.map].at(view.frame_index), camera(), {});
  };
  KeyframeDepthOptions options{.min_points = options_.min_points,
                               .keeps_completed = options_.completion};
  if (!options_.stereo) options.baselines.clear();
  try {
    return orb360::ComputeDepth(views, frames, landmarks_of, options, images_, &completer_,
                                num_threads_, depth_maps_, progress);
  } catch (const UserError&) {
    images_.Clear();
    throw;
  }
}

std::optional<KnownGround> DenseMapper::Ground() const {
  constexpr size_t kEnough = 10;      // keyframes
  constexpr double kMaxSigma = 0.05;  // standard deviation of ln(height)
  if (grounds_.size() < kEnough) return std::nullopt;
  const DenseGround fused = FuseGrounds(grounds_).value();
  if (fused.sigma > kMaxSigma) return std::nullopt;
  return KnownGround{.up = fused.up, .camera_height = std::exp(fused.log_height), .is_rough = true};
}

}  // namespace orb360
