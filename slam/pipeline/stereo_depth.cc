#include "slam/pipeline/stereo_depth.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include <opencv2/imgproc.hpp>

namespace orb360 {
namespace {

/// The images of the views that were used last.
class GrayImages {
 public:
  GrayImages(std::span<const DenseView> views, const DepthMapStore& store)
      : views_(views), store_(store) {}

  StereoView Get(size_t index) {
    const auto found = std::ranges::find(images_, index, &Entry::index);
    if (found != images_.end()) return {found->gray, views_[index].world_from_camera};
    cv::Mat gray;
    cv::cvtColor(store_.Get(views_[index].frame_index).color, gray, cv::COLOR_BGR2GRAY);
    if (images_.size() >= kCapacity) images_.pop_front();
    images_.push_back({index, gray});
    return {gray, views_[index].world_from_camera};
  }

 private:
  static constexpr size_t kCapacity = 32;

  struct Entry {
    size_t index;
    cv::Mat gray;
  };

  std::span<const DenseView> views_;
  const DepthMapStore& store_;
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

std::vector<size_t> ChooseStereoSources(std::span<const DenseView> views, size_t reference,
                                        double median_range, const StereoDepthOptions& options) {
  std::vector<size_t> chosen;
  for (const double baseline : options.baselines) {
    for (const bool is_after : {false, true}) {
      std::optional<size_t> best;
      double least = std::log(options.max_baseline_ratio);
      for (const size_t index : views[reference].neighbours) {
        if ((index > reference) != is_after || std::ranges::find(chosen, index) != chosen.end()) {
          continue;
        }
        const double distance = (views[index].world_from_camera.translation -
                                 views[reference].world_from_camera.translation)
                                    .norm();
        if (!(distance > 0)) continue;
        const double difference = std::abs(std::log(distance / (baseline * median_range)));
        if (difference >= least) continue;
        least = difference;
        best = index;
      }
      if (best) chosen.push_back(*best);
    }
  }
  return chosen;
}

int MeasureDepth(std::span<const DenseView> views, const StereoDepthOptions& options,
                 const DepthMapStore& store, DepthCompleter* completer, int num_threads,
                 const KeyframeProgress& progress) {
  GrayImages images(views, store);
  const auto count = static_cast<int>(views.size());
  int num_measured = 0;
  for (int i = 0; i < count; ++i) {
    if (progress && !progress(i, count)) break;
    const DenseDepth stored = store.Get(views[i].frame_index);
    const double scale = views[i].scale;
    // The network gives the sky ranges too, with little confidence.
    cv::Mat trusted = stored.range.clone();
    trusted.setTo(0, ~(stored.confidence >= options.min_trusted_confidence));
    const double median_range = scale * MedianRange(trusted);
    if (!(median_range > 0)) continue;
    std::vector<StereoView> sources;
    for (const size_t index : ChooseStereoSources(views, i, median_range, options)) {
      sources.push_back(images.Get(index));
    }
    if (static_cast<int>(sources.size()) < options.stereo.fusion.min_support) continue;
    const InverseRanges seen = MatchSpheres(images.Get(i), sources, options.stereo, num_threads);
    const std::optional<SparseDepth> sparse = SampleSquares(seen, options);
    if (!sparse) continue;
    DenseDepth completed = completer->Complete(stored.color, *sparse);
    Merge(seen, options.completion_error_factor, &completed);
    store.PutRanges(views[i].frame_index, completed.range / scale, completed.confidence);
    ++num_measured;
  }
  return num_measured;
}

}  // namespace orb360
