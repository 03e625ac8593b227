#include "slam/pipeline/pending_frames.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360 {

void PendingFrames::Remember(PendingFrame frame) {
  if (!frames_.empty() && frames_.back().index != reference_) frames_.back().image.reset();
  frames_.push_back(std::move(frame));
  const auto is_kept = [](const PendingFrame& f) { return f.features != nullptr; };
  if (std::ranges::count_if(frames_, is_kept) <= max_frames_) return;
  const auto oldest = std::ranges::find_if(
      frames_, [&](const PendingFrame& f) { return is_kept(f) && f.index != reference_; });
  if (oldest->turn) {
    oldest->features.reset();
  } else {
    frames_.erase(oldest);
  }
}

void PendingFrames::Forget(int index) {
  std::erase_if(frames_, [index](const PendingFrame& f) { return f.index == index; });
}

const PendingFrame& PendingFrames::Reference() {
  ORB360_CHECK(!frames_.empty());
  auto reference = std::ranges::find(frames_, reference_, &PendingFrame::index);
  if (reference == frames_.end()) reference = std::prev(frames_.end());
  reference_ = reference->index;
  return *reference;
}

bool PendingFrames::AdvanceReference() {
  return std::exchange(reference_, frames_.back().index) != reference_;
}

std::vector<PendingFrame> PendingFrames::TakeNewestFirst() {
  std::vector<PendingFrame> taken(std::make_move_iterator(frames_.begin()),
                                  std::make_move_iterator(frames_.end()));
  frames_.clear();
  std::ranges::sort(taken, std::ranges::greater(), &PendingFrame::index);
  return taken;
}

}  // namespace orb360
