#include "slam/pipeline/view_depth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "slam/pipeline/fifo_cache.h"
#include "slam/pipeline/view_completion.h"
#include "slam/pipeline/view_ranges.h"
#include "slam/pipeline/view_selection.h"

namespace orb360 {
namespace {

/// Where one side of the path has no source view, the other side gives those at this multiple of
/// the baselines, about the root of their ratio: views beside each other have the same errors.
constexpr double kBetweenBaselines = 1.8;
constexpr size_t kRecentImages = 32;

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

/// The first pass of ComputeDepth.
ViewDepthReport MeasureViews(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                             const LandmarkProjector& landmarks_of,
                             const std::optional<Eigen::Vector3d>& up,
                             const ViewDepthOptions& options, const ImageStore& images,
                             DepthCompleter* completer, int num_threads, const DepthMapStore& store,
                             const ViewProgress& progress) {
  std::optional<PlaneHypothesis> ground;
  if (up && options.camera_height > 0) ground = {*up, options.camera_height};
  FifoCache<cv::Mat> gray(kRecentImages,
                          [&](size_t i) { return images.GetGray(views[i].frame_index); });
  const auto stereo_view = [&](size_t i) {
    return StereoView{gray.Get(i), views[i].world_from_camera};
  };
  const auto count = static_cast<int>(views.size());
  ViewDepthReport report;
  bool uses_stereo = !options.baselines.empty();
  std::map<int, double> path_lengths = PathLengths(views);
  const DenseView* last = nullptr;  // The reference view before.
  double range = 0;                 // Of its surroundings; 0: not known.
  for (int i = 0; i < count; ++i) {
    if (progress && !progress(i, 2 * count)) uses_stereo = false;
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
        sources.push_back(stereo_view(source));
      }
      if (static_cast<int>(sources.size()) < options.stereo.fusion.min_support) {
        ++report.without_sources;
      } else {
        seen = MatchSpheres(stereo_view(static_cast<size_t>(i)), sources, options.stereo,
                            num_threads, ground);
        is_measured = SampleSquares(seen, options.sparse_spacing, options.min_fraction,
                                    options.sparse, &sparse);
        ++(is_measured ? report.measured : report.unseen);
      }
    }
    const bool is_completed =
        options.keeps_completed && static_cast<int>(landmarks.size()) >= options.min_points;
    if (!is_measured && !is_completed) continue;
    DenseDepth depth = completer->Complete(color, sparse);
    range = TrustedRange(depth, options.min_trusted_confidence);
    if (!options.baselines.empty()) StateCompleted(options.completed_error_factor, &depth);
    if (is_measured) PutMeasured(seen, &depth);
    store.Put(view.frame_index, depth);
  }
  return report;
}

}  // namespace

std::vector<size_t> ChooseStereoSources(std::span<const DenseView> views, size_t reference,
                                        std::span<const size_t> neighbours, double median_range,
                                        const ViewDepthOptions& options) {
  std::vector<double> distances = options.baselines;
  for (double& distance : distances) distance *= median_range;
  const auto choose = [&](std::span<const size_t> from) {
    return ChooseViewsByDistance(views, reference, from, distances, options.max_baseline_ratio);
  };
  std::vector<size_t> sources = choose(neighbours);
  const size_t wanted = 2 * distances.size();
  if (!sources.empty() && sources.size() < wanted) {
    std::vector<size_t> others(neighbours.begin(), neighbours.end());
    std::erase_if(others, [&](size_t i) { return std::ranges::find(sources, i) != sources.end(); });
    for (double& distance : distances) distance *= kBetweenBaselines;
    for (const size_t i : choose(others)) {
      if (sources.size() < wanted) sources.push_back(i);
    }
  }
  return sources;
}

ViewDepthReport ComputeDepth(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                             const LandmarkProjector& landmarks_of,
                             const std::optional<Eigen::Vector3d>& up,
                             const ViewDepthOptions& options, const ImageStore& images,
                             DepthCompleter* completer, int num_threads, const DepthMapStore& first,
                             const DepthMapStore& store, const ViewDepthCallbacks& callbacks) {
  ViewDepthReport report = MeasureViews(views, neighbours_of, landmarks_of, up, options, images,
                                        completer, num_threads, first, callbacks.progress);
  report.with_moving_objects =
      CompleteViews(views, neighbours_of, landmarks_of, up, options, images, completer, num_threads,
                    first, store, callbacks);
  return report;
}

}  // namespace orb360
