#include "slam/pipeline/dense_mapper.h"

#include <cmath>
#include <utility>

#include "slam/pipeline/stereo_depth.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

DenseMapper::DenseMapper(const std::filesystem::path& weights, const std::filesystem::path& folder,
                         const DepthOptions& options, int num_threads)
    : options_(options),
      num_threads_(num_threads),
      depth_maps_(folder),
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

int DenseMapper::MeasureDepth(std::span<const DenseView> views, const KeyframeProgress& progress) {
  if (failure_) return 0;
  return orb360::MeasureDepth(views, {.sparse = options_.sparse}, depth_maps_, &completer_,
                              num_threads_, progress);
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
