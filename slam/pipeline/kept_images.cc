#include "slam/pipeline/kept_images.h"

#include <opencv2/imgproc.hpp>

#include <orb360/nn/base/check.h>

namespace orb360 {

void KeptImages::KeepUnplaced(int frame_index, const cv::Mat& image) {
  constexpr size_t kMax = 100;
  Keep(frame_index, image);
  unplaced_.push_back(frame_index);
  if (unplaced_.size() <= kMax + 1) return;
  // The first one may be the reference of the next map's beginning.
  store_.Remove(unplaced_[1]);
  unplaced_.erase(unplaced_.begin() + 1);
}

void KeptImages::KeepTracked(int frame_index, const cv::Mat& image, const Rigid3& world_from_camera,
                             double median_range) {
  // A sixth of the nearest source view's distance (ViewDepthOptions::baselines).
  constexpr double kMinMotion = 0.02;
  const Eigen::Vector3d& place = world_from_camera.translation;
  const bool is_first = !last_place_ || !unplaced_.empty();
  unplaced_.clear();
  if (!is_first &&
      (!between_keyframes_ || (place - *last_place_).norm() < kMinMotion * median_range)) {
    return;
  }
  last_place_ = place;
  Keep(frame_index, image);
}

void KeptImages::Keep(int frame_index, const cv::Mat& image) {
  if (last_frame_ == frame_index) return;
  Flush();
  if (failure_) return;
  last_frame_ = frame_index;
  cv::Mat small;
  cv::resize(image, small, size_, 0, 0, cv::INTER_AREA);
  // cv::resize returns the image of the caller itself where the sizes are equal.
  if (small.data == image.data) small = image.clone();
  storing_ = std::async(std::launch::async,
                        [this, frame_index, small] { store_.Put(frame_index, small); });
}

// On a full disk only the dense cloud is lost, not the trajectory, which needs the room.
void KeptImages::Flush() {
  if (!storing_.valid()) return;
  try {
    storing_.get();
  } catch (const UserError&) {
    failure_ = std::current_exception();
    Clear();
  }
}

}  // namespace orb360
