#include "slam/pipeline/dense_mapper.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/pipeline/stereo_depth.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

DenseMapper::DenseMapper(const std::filesystem::path& weights, const std::filesystem::path& folder,
                         const DepthOptions& options, int num_threads)
    : options_(options),
      num_threads_(num_threads),
      depth_maps_(folder),
      images_(folder / "images"),
      completer_(weights, {.size = {2 * options.height, options.height}, .threads = num_threads}),
      completion_(
          &completer_,
          [this](int frame_index, const DenseDepth& depth) { Store(frame_index, depth); },
          options) {}

// It is called on other threads, one call at a time. On a full disk only the dense cloud is lost,
// not the trajectory.
void DenseMapper::Store(int frame_index, const DenseDepth& depth) {
  if (failure_) return;
  try {
    depth_maps_.Put(frame_index, depth);
  } catch (const UserError&) {
    failure_ = std::current_exception();
  }
}

void DenseMapper::Start(const Keyframe& keyframe, const cv::Mat& color,
                        std::vector<SparsePoint> points, int num_frames) {
  if (completion_.Start(keyframe, color, std::move(points), num_frames)) {
    frames_.push_back(keyframe.frame_index);
  }
}

void DenseMapper::KeepImage(int frame_index, const cv::Mat& image, const Rigid3& world_from_camera,
                            double median_range) {
  // A sixth of the nearest source view's distance (StereoDepthOptions::baselines).
  constexpr double kMinMotion = 0.02;
  const Eigen::Vector3d& position = world_from_camera.translation;
  if (last_kept_ && (position - *last_kept_).norm() < kMinMotion * median_range) return;
  AwaitImage();
  if (image_failure_) return;
  last_kept_ = position;
  cv::Mat small;
  cv::resize(image, small, {camera().width(), camera().height()}, 0, 0, cv::INTER_AREA);
  keeping_ = std::async(std::launch::async, [this, frame_index, small] {
    cv::Mat gray;
    cv::cvtColor(small, gray, cv::COLOR_BGR2GRAY);
    images_.Put(frame_index, gray);
  });
}

void DenseMapper::AwaitImage() {
  if (!keeping_.valid()) return;
  try {
    keeping_.get();
  } catch (const UserError&) {
    image_failure_ = std::current_exception();
  }
}

void DenseMapper::Flush() {
  AwaitImage();
  completion_.Flush();
}

int DenseMapper::MeasureDepth(std::span<const DenseView> views, std::span<const FramePose> frames,
                              const KeyframeProgress& progress) {
  if (failure()) return 0;
  std::vector<FramePose> kept;
  std::ranges::copy_if(frames, std::back_inserter(kept),
                       [this](const FramePose& frame) { return images_.Contains(frame.index); });
  return orb360::MeasureDepth(views, kept, {.sparse = options_.sparse}, depth_maps_, images_,
                              &completer_, num_threads_, progress);
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
