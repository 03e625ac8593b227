#include "slam/pipeline/view_depth.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>

#include "slam/pipeline/view_selection.h"

namespace orb360 {
namespace {

/// The images of frames that were used last.
class GrayImages {
 public:
  explicit GrayImages(const ImageStore& store) : store_(store) {}

  cv::Mat Get(int frame_index) {
    const auto found = std::ranges::find(images_, frame_index, &Entry::frame_index);
    if (found != images_.end()) return found->gray;
    if (images_.size() >= kCapacity) images_.pop_front();
    images_.push_back({frame_index, store_.GetGray(frame_index)});
    return images_.back().gray;
  }

 private:
  static constexpr size_t kCapacity = 32;

  struct Entry {
    int frame_index;
    cv::Mat gray;
  };

  const ImageStore& store_;
  std::deque<Entry> images_;
};

// The median of the ranges that the network is sure of, or of all where there are none. It gives
// the sky ranges too, with little confidence.
double TrustedRange(const DenseDepth& depth, double min_confidence) {
  cv::Mat trusted = depth.range.clone();
  trusted.setTo(0, ~(depth.confidence >= min_confidence));
  const double range = MedianRange(trusted);
  return range > 0 ? range : MedianRange(depth.range);
}

float ConfidenceOf(float relative_error) { return 1.0f / (1.0f + relative_error); }

// Puts one pixel of each square that has any into the sparse depth, in the place of what that has
// in the square: the first one by rows from the middle on. False, without a change, where too few
// squares have one.
bool SampleSquares(const InverseRanges& seen, const ViewDepthOptions& options,
                   SparseDepth* sparse) {
  const cv::Size size = seen.value.size();
  const int side = options.sparse_spacing;
  int num_squares = 0;
  std::vector<cv::Point> chosen;
  for (int top = 0; top < size.height; top += side) {
    for (int left = 0; left < size.width; left += side) {
      ++num_squares;
      for (int i = 0; i < side * side; ++i) {
        const int at = (i + side * side / 2) % (side * side);
        const int row = top + at / side;
        const int column = left + at % side;
        if (row >= size.height || column >= size.width) continue;
        if (!(seen.value.at<float>(row, column) > 0)) continue;
        chosen.emplace_back(column, row);
        break;
      }
    }
  }
  if (static_cast<double>(chosen.size()) < options.min_fraction * num_squares) return false;
  for (const cv::Point& pixel : chosen) {
    const cv::Rect square =
        cv::Rect(pixel.x / side * side, pixel.y / side * side, side, side) & cv::Rect({}, size);
    sparse->range(square) = 0;
    sparse->confidence(square) = 0;
    const float value = seen.value.at<float>(pixel);
    sparse->range.at<float>(pixel) = 1 / value;
    sparse->confidence.at<float>(pixel) =
        static_cast<float>(SparseConfidence(seen.sigma.at<float>(pixel) / value, options.sparse));
  }
  return true;
}

// Multiplies the errors that the network expects.
void Distrust(double error_factor, DenseDepth* completed) {
  for (int row = 0; row < completed->confidence.rows; ++row) {
    for (int column = 0; column < completed->confidence.cols; ++column) {
      float& confidence = completed->confidence.at<float>(row, column);
      if (!(confidence > 0)) continue;
      confidence = ConfidenceOf(static_cast<float>(error_factor) * (1 / confidence - 1));
    }
  }
}

// Puts ranges that were seen in the place of completed ones.
void TakeOver(const InverseRanges& seen, DenseDepth* depth) {
  for (int row = 0; row < seen.value.rows; ++row) {
    for (int column = 0; column < seen.value.cols; ++column) {
      const float value = seen.value.at<float>(row, column);
      if (!(value > 0)) continue;
      depth->range.at<float>(row, column) = 1 / value;
      depth->confidence.at<float>(row, column) =
          ConfidenceOf(seen.sigma.at<float>(row, column) / value);
    }
  }
}

// Length of the path in each map.
std::map<int, double> PathLengths(std::span<const DenseView> views) {
  std::map<int, double> lengths;
  std::map<int, const DenseView*> last;
  for (const DenseView& view : views) {
    const DenseView*& before = last[view.map];
    if (before != nullptr) lengths[view.map] += DistanceBetween(*before, view);
    before = &view;
  }
  return lengths;
}

}  // namespace

std::vector<size_t> ChooseStereoSources(std::span<const DenseView> views, size_t reference,
                                        std::span<const size_t> neighbours, double median_range,
                                        const ViewDepthOptions& options) {
  std::vector<double> distances = options.baselines;
  for (double& distance : distances) distance *= median_range;
  return ChooseViewsByDistance(views, reference, neighbours, distances, options.max_baseline_ratio);
}

ViewDepthReport ComputeDepth(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                             const LandmarkProjector& landmarks_of, const ViewDepthOptions& options,
                             const ImageStore& images, DepthCompleter* completer, int num_threads,
                             const DepthMapStore& store, const ViewDepthCallbacks& callbacks) {
  GrayImages gray(images);
  const auto stereo_view = [&](const DenseView& view) {
    return StereoView{gray.Get(view.frame_index), view.world_from_camera};
  };
  const auto count = static_cast<int>(views.size());
  ViewDepthReport report;
  bool uses_stereo = !options.baselines.empty();
  std::map<int, double> path_lengths = PathLengths(views);
  const DenseView* last = nullptr;  // The reference view before.
  double range = 0;                 // Of its surroundings; 0: not known.
  for (int i = 0; i < count; ++i) {
    if (callbacks.progress && !callbacks.progress(i, count)) uses_stereo = false;
    const DenseView& view = views[i];
    if (last != nullptr && last->map != view.map) {
      last = nullptr;
      range = 0;
    }
    double spacing = path_lengths[view.map] / options.min_views;
    if (range > 0) spacing = std::min(spacing, options.spacing * range);
    if (last != nullptr && DistanceBetween(view, *last) <= spacing) continue;
    last = &view;
    const std::vector<SparsePoint> landmarks = landmarks_of(view);
    SparseDepth sparse = RenderSparseDepth(landmarks, completer->camera());
    const cv::Mat color = images.Get(view.frame_index);
    if (!(range > 0) && !landmarks.empty()) {
      range = TrustedRange(completer->Complete(color, sparse), options.min_trusted_confidence);
    }
    InverseRanges seen;
    bool is_measured = false;
    if (uses_stereo) {
      std::vector<StereoView> sources;
      for (const size_t source : ChooseStereoSources(views, i, neighbours_of(i), range, options)) {
        sources.push_back(stereo_view(views[source]));
      }
      if (static_cast<int>(sources.size()) < options.stereo.fusion.min_support) {
        ++report.without_sources;
      } else {
        seen = MatchSpheres(stereo_view(view), sources, options.stereo, num_threads);
        is_measured = SampleSquares(seen, options, &sparse);
        ++(is_measured ? report.measured : report.unseen);
      }
    }
    const bool is_completed =
        options.keeps_completed && static_cast<int>(landmarks.size()) >= options.min_points;
    if (!is_measured && !is_completed) continue;
    if (callbacks.sink)
      callbacks.sink({color, sparse, view.frame_index, view.timestamp, view.world_from_camera});
    DenseDepth depth = completer->Complete(color, sparse);
    range = TrustedRange(depth, options.min_trusted_confidence);
    if (!options.baselines.empty()) Distrust(options.completion_error_factor, &depth);
    if (is_measured) TakeOver(seen, &depth);
    if (!options.keeps_completed) depth.confidence.setTo(0, ~(seen.value > 0));
    if (callbacks.watcher) callbacks.watcher(view.frame_index, view.world_from_camera, depth);
    store.Put(view.frame_index, depth);
  }
  return report;
}

}  // namespace orb360
