#include "slam/pipeline/stereo_depth.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include <opencv2/imgproc.hpp>

namespace orb360 {
namespace {

/// The images of frames that were used last.
class GrayImages {
 public:
  GrayImages(const DepthMapStore& keyframes, const GrayImageStore& frames)
      : keyframes_(keyframes), frames_(frames) {}

  cv::Mat Get(int frame_index) {
    const auto found = std::ranges::find(images_, frame_index, &Entry::frame_index);
    if (found != images_.end()) return found->gray;
    if (images_.size() >= kCapacity) images_.pop_front();
    images_.push_back({frame_index, Load(frame_index)});
    return images_.back().gray;
  }

 private:
  static constexpr size_t kCapacity = 32;

  struct Entry {
    int frame_index;
    cv::Mat gray;
  };

  cv::Mat Load(int frame_index) const {
    if (!keyframes_.Contains(frame_index)) return frames_.Get(frame_index);
    cv::Mat gray;
    cv::cvtColor(keyframes_.Get(frame_index).color, gray, cv::COLOR_BGR2GRAY);
    return gray;
  }

  const DepthMapStore& keyframes_;
  const GrayImageStore& frames_;
  std::deque<Entry> images_;
};

float ConfidenceOf(float relative_error) { return 1.0f / (1.0f + relative_error); }

// One pixel of each square that has any: the first one by rows from the middle on. None where too
// few squares have one.
std::optional<SparseDepth> SampleSquares(const InverseRanges& seen,
                                         const StereoDepthOptions& options) {
  const cv::Size size = seen.value.size();
  SparseDepth sparse{cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F)};
  const int side = options.sparse_spacing;
  int num_squares = 0;
  int count = 0;
  for (int top = 0; top < size.height; top += side) {
    for (int left = 0; left < size.width; left += side) {
      ++num_squares;
      for (int i = 0; i < side * side; ++i) {
        const int at = (i + side * side / 2) % (side * side);
        const int row = top + at / side;
        const int column = left + at % side;
        if (row >= size.height || column >= size.width) continue;
        const float value = seen.value.at<float>(row, column);
        if (!(value > 0)) continue;
        sparse.range.at<float>(row, column) = 1 / value;
        sparse.confidence.at<float>(row, column) = static_cast<float>(
            SparseConfidence(seen.sigma.at<float>(row, column) / value, options.sparse));
        ++count;
        break;
      }
    }
  }
  if (count < options.min_fraction * num_squares) return std::nullopt;
  return sparse;
}

// Ranges in the unit of `seen`: those seen, and those completed elsewhere.
void Merge(const InverseRanges& seen, double completion_error_factor, DenseDepth* completed) {
  for (int row = 0; row < seen.value.rows; ++row) {
    for (int column = 0; column < seen.value.cols; ++column) {
      float& range = completed->range.at<float>(row, column);
      float& confidence = completed->confidence.at<float>(row, column);
      const float value = seen.value.at<float>(row, column);
      if (value > 0) {
        range = 1 / value;
        confidence = ConfidenceOf(seen.sigma.at<float>(row, column) / value);
      } else if (confidence > 0) {
        confidence =
            ConfidenceOf(static_cast<float>(completion_error_factor) * (1 / confidence - 1));
      }
    }
  }
}

}  // namespace

std::vector<FramePose> FindStereoCandidates(std::span<const DenseView> views, size_t reference,
                                            std::span<const FramePose> frames) {
  std::vector<size_t> near = views[reference].neighbours;
  near.push_back(reference);
  std::ranges::sort(near);
  std::vector<FramePose> candidates;
  for (size_t i = 0; i < near.size(); ++i) {
    const DenseView& view = views[near[i]];
    if (near[i] != reference) {
      candidates.push_back({view.frame_index, 0, view.map, view.world_from_camera});
    }
    if (i + 1 == near.size() || near[i + 1] != near[i] + 1) continue;
    const int end = views[near[i + 1]].frame_index;
    for (auto frame = std::ranges::upper_bound(frames, view.frame_index, {}, &FramePose::index);
         frame != frames.end() && frame->index < end; ++frame) {
      if (frame->map == view.map) candidates.push_back(*frame);
    }
  }
  return candidates;
}

std::vector<FramePose> ChooseStereoSources(std::span<const FramePose> candidates,
                                           const DenseView& reference, double median_range,
                                           const StereoDepthOptions& options) {
  std::vector<FramePose> chosen;
  for (const double baseline : options.baselines) {
    for (const bool is_after : {false, true}) {
      const FramePose* best = nullptr;
      double least = std::log(options.max_baseline_ratio);
      for (const FramePose& frame : candidates) {
        if ((frame.index > reference.frame_index) != is_after ||
            std::ranges::find(chosen, frame.index, &FramePose::index) != chosen.end()) {
          continue;
        }
        const double distance =
            (frame.world_from_camera.translation - reference.world_from_camera.translation).norm();
        if (!(distance > 0)) continue;
        const double difference = std::abs(std::log(distance / (baseline * median_range)));
        if (difference >= least) continue;
        least = difference;
        best = &frame;
      }
      if (best != nullptr) chosen.push_back(*best);
    }
  }
  return chosen;
}

int MeasureDepth(std::span<const DenseView> views, std::span<const FramePose> frames,
                 const StereoDepthOptions& options, const DepthMapStore& store,
                 const GrayImageStore& images, DepthCompleter* completer, int num_threads,
                 const KeyframeProgress& progress) {
  GrayImages gray(store, images);
  const auto count = static_cast<int>(views.size());
  int num_measured = 0;
  for (int i = 0; i < count; ++i) {
    if (progress && !progress(i, count)) break;
    const DenseView& view = views[i];
    const DenseDepth stored = store.Get(view.frame_index);
    // The network gives the sky ranges too, with little confidence.
    cv::Mat trusted = stored.range.clone();
    trusted.setTo(0, ~(stored.confidence >= options.min_trusted_confidence));
    const double median_range = view.scale * MedianRange(trusted);
    if (!(median_range > 0)) continue;
    std::vector<StereoView> sources;
    for (const FramePose& frame :
         ChooseStereoSources(FindStereoCandidates(views, i, frames), view, median_range, options)) {
      sources.push_back({gray.Get(frame.index), frame.world_from_camera});
    }
    if (static_cast<int>(sources.size()) < options.stereo.fusion.min_support) continue;
    const InverseRanges seen = MatchSpheres({gray.Get(view.frame_index), view.world_from_camera},
                                            sources, options.stereo, num_threads);
    const std::optional<SparseDepth> sparse = SampleSquares(seen, options);
    if (!sparse) continue;
    DenseDepth completed = completer->Complete(stored.color, *sparse);
    Merge(seen, options.completion_error_factor, &completed);
    store.PutRanges(view.frame_index, completed.range / view.scale, completed.confidence);
    ++num_measured;
  }
  return num_measured;
}

}  // namespace orb360
