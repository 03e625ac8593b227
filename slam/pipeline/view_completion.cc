#include "slam/pipeline/view_completion.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <utility>

#include "slam/depth/dense_ground.h"
#include "slam/depth/ground_points.h"
#include "slam/depth/occluding_boundary.h"
#include "slam/pipeline/view_ranges.h"
#include "slam/pipeline/view_selection.h"

namespace orb360 {
namespace {

constexpr double kMinError = 0.01;  // of ln(range); a measured pixel is told from others by more
// Stated of the range beside the edge of a near surface, as of objects that move along: it stays in
// the depth, but not in the cloud.
constexpr double kBoundaryError = 1.0;
// Where the network expects a larger relative error it may see the sky, of which it is trained to
// state 1. It gives that the range of the roofs around it.
constexpr double kSkyError = 0.5;

/// A view of the first pass, and the colours that it sees.
struct SeenDepth {
  DepthView depth;
  cv::Mat colors;
};

/// The views of the first pass that were used last.
class RecentViews {
 public:
  RecentViews(std::span<const DenseView> views, const DepthMapStore& store,
              const ImageStore& images)
      : views_(views), store_(store), images_(images) {}

  std::shared_ptr<const SeenDepth> Get(size_t index) {
    const auto found = std::ranges::find(recent_, index, &Entry::index);
    if (found != recent_.end()) return found->view;
    if (recent_.size() >= kCapacity) recent_.pop_front();
    const DenseView& view = views_[index];
    const DenseDepth depth = store_.Get(view.frame_index);
    recent_.push_back(
        {index, std::make_shared<const SeenDepth>(
                    DepthView(depth, view.world_from_camera, kMinError),
                    SurfaceColors(images_.Get(view.frame_index), depth.range.size()))});
    return recent_.back().view;
  }

 private:
  static constexpr size_t kCapacity = 48;  // 4 MB each for 1024 x 512 pixels

  struct Entry {
    size_t index;
    std::shared_ptr<const SeenDepth> view;
  };

  std::span<const DenseView> views_;
  const DepthMapStore& store_;
  const ImageStore& images_;
  std::deque<Entry> recent_;
};

/// Views that a function looks at, which live as long as this.
using LoadedViews = std::vector<std::shared_ptr<const SeenDepth>>;

std::vector<const DepthView*> DepthsOf(const LoadedViews& loaded) {
  std::vector<const DepthView*> depths;
  for (const auto& view : loaded) depths.push_back(&view->depth);
  return depths;
}

std::vector<SeenView> SeenBy(const LoadedViews& loaded) {
  std::vector<SeenView> seen;
  for (const auto& view : loaded) seen.push_back({&view->depth, &view->colors});
  return seen;
}

LoadedViews LoadByDistance(std::span<const DenseView> views, size_t reference,
                           std::span<const size_t> neighbours, std::vector<double> distances,
                           double unit, double max_ratio, RecentViews* recent) {
  for (double& distance : distances) distance *= unit;
  LoadedViews loaded;
  for (const size_t i : ChooseViewsByDistance(views, reference, neighbours, distances, max_ratio)) {
    loaded.push_back(recent->Get(i));
  }
  return loaded;
}

InverseRanges NothingMeasured(cv::Size size) {
  return {cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F)};
}

/// The objects that move along in a view, and the ground on which they stand.
struct ObjectsOnGround {
  std::vector<MovingObject> objects;
  std::optional<DenseGround> ground;
};

/// `others_at` gives the views at distances in heights of the camera, whose length is given.
ObjectsOnGround FindObjects(const DenseDepth& depth, const DepthView& view,
                            const Eigen::Vector3d& up, const ViewCompletionOptions& options,
                            const std::function<LoadedViews(double height)>& others_at) {
  const std::optional<DenseGround> ground =
      FindGround(depth, view.world_from_camera().rotation.inverse() * up, options.ground);
  if (!ground) return {};
  const cv::Mat below = FindBelowGround(view, *ground, options.objects);
  if (cv::countNonZero(below) == 0) return {};
  const LoadedViews others = others_at(std::exp(ground->log_height));
  return {FindMovingObjects(below, view, *ground, DepthsOf(others), options.objects), ground};
}

/// One view before the network completes it.
struct PreparedView {
  DenseDepth depth;        // Of the first pass.
  InverseRanges measured;  // Of that, without objects that move along.
  ObjectsOnGround found;
  SparseDepth sparse;
  cv::Mat color;
  bool is_completed = false;
};

/// Prepares views, one at a time and in their order. It reads the first pass only, so that one view
/// can be prepared while the network completes another.
class ViewPreparation {
 public:
  ViewPreparation(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                  const LandmarkProjector& landmarks_of, const std::optional<Eigen::Vector3d>& up,
                  const ViewDepthOptions& options, const ImageStore& images,
                  const EquirectangularCamera& camera, int num_threads, const DepthMapStore& first)
      : views_(views),
        neighbours_of_(neighbours_of),
        landmarks_of_(landmarks_of),
        up_(up),
        options_(options),
        images_(images),
        camera_(camera),
        num_threads_(num_threads),
        first_(first),
        recent_(views, first, images) {}

  PreparedView Prepare(size_t i, bool is_interrupted) {
    const DenseView& view = views_[i];
    const ViewCompletionOptions& second = options_.second;
    const bool has_stereo = !options_.baselines.empty();
    DenseDepth depth = first_.Get(view.frame_index);
    InverseRanges measured = has_stereo ? MeasuredOf(depth) : NothingMeasured(depth.range.size());
    std::vector<size_t> neighbours = neighbours_of_(i);
    std::erase_if(neighbours, [&](size_t n) { return !first_.Contains(views_[n].frame_index); });
    const auto load = [&](const std::vector<double>& distances, double unit) {
      return LoadByDistance(views_, i, neighbours, distances, unit, second.max_distance_ratio,
                            &recent_);
    };
    ObjectsOnGround found;
    if (up_ && !is_interrupted) {
      found = FindObjects(depth, recent_.Get(i)->depth, *up_, second,
                          [&](double height) { return load(second.ground_distances, height); });
    }
    const cv::Mat moving = MaskOf(found.objects, depth.range.size());
    measured.value.setTo(0, moving);
    SparseDepth sparse = RenderSparseDepth(landmarks_of_(view), camera_);
    SampleSquares(measured, options_.sparse_spacing, 0, options_.sparse, &sparse);
    const bool is_completed = has_stereo && !is_interrupted;
    if (is_completed) {
      const double range = TrustedRange(depth, options_.min_trusted_confidence);
      const LoadedViews others = load(second.distances, range);
      AddReprojectedPoints(view.world_from_camera, recent_.Get(i)->colors, SeenBy(others),
                           {.spacing = options_.sparse_spacing,
                            .max_error = kLargestMeasuredError,
                            .sparse = options_.sparse},
                           &sparse, num_threads_);
      if (up_ && options_.camera_height > 0) {
        AddGroundPoints(view.world_from_camera.rotation.inverse() * *up_, options_.camera_height,
                        {.sparse = options_.sparse}, &sparse);
      }
    }
    sparse.range.setTo(0, moving);
    sparse.confidence.setTo(0, moving);
    return {.depth = std::move(depth),
            .measured = std::move(measured),
            .found = std::move(found),
            .sparse = std::move(sparse),
            .color = images_.Get(view.frame_index),
            .is_completed = is_completed};
  }

 private:
  std::span<const DenseView> views_;
  const NeighbourFinder& neighbours_of_;
  const LandmarkProjector& landmarks_of_;
  const std::optional<Eigen::Vector3d>& up_;
  const ViewDepthOptions& options_;
  const ImageStore& images_;
  const EquirectangularCamera& camera_;
  int num_threads_;
  const DepthMapStore& first_;
  RecentViews recent_;
};

/// Completes a view by the network, and keeps what was measured.
void Complete(const PreparedView& view, const ViewDepthOptions& options, DepthCompleter* completer,
              DenseDepth* depth) {
  *depth = completer->Complete(view.color, view.sparse);
  cv::Mat surfaces = depth->range.clone();
  surfaces.setTo(std::numeric_limits<float>::infinity(), depth->confidence < 1 / (1 + kSkyError));
  Distrust(options.completion_error_factor, depth);
  PutMeasured(view.measured, depth);
  depth->range.copyTo(surfaces, view.measured.value > 0);
  LimitConfidence(FindOccludingBoundary(surfaces), kBoundaryError, depth);
}

}  // namespace

int CompleteViews(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                  const LandmarkProjector& landmarks_of, const std::optional<Eigen::Vector3d>& up,
                  const ViewDepthOptions& options, const ImageStore& images,
                  DepthCompleter* completer, int num_threads, const DepthMapStore& first,
                  const DepthMapStore& store, const ViewDepthCallbacks& callbacks) {
  ViewPreparation preparation(views, neighbours_of, landmarks_of, up, options, images,
                              completer->camera(), num_threads, first);
  const auto count = static_cast<int>(views.size());
  bool is_interrupted = false;
  // Reports the progress up to the next view that has a depth, and starts to prepare that one.
  size_t started = 0;
  const auto start_next = [&]() -> std::future<PreparedView> {
    while (started < views.size()) {
      const size_t i = started++;
      if (callbacks.progress && !callbacks.progress(count + static_cast<int>(i), 2 * count)) {
        is_interrupted = true;
      }
      if (first.Contains(views[i].frame_index)) {
        return std::async(std::launch::async, &ViewPreparation::Prepare, &preparation, i,
                          is_interrupted);
      }
    }
    return {};
  };
  int num_with_objects = 0;
  std::future<PreparedView> next = start_next();
  while (next.valid()) {
    const DenseView& view = views[started - 1];
    PreparedView now = next.get();
    next = start_next();
    if (callbacks.sink) {
      callbacks.sink(
          {now.color, now.sparse, view.frame_index, view.timestamp, view.world_from_camera});
    }
    DenseDepth depth = std::move(now.depth);
    if (now.is_completed) Complete(now, options, completer, &depth);
    if (!now.found.objects.empty()) {
      PlaceOnGround(now.found.objects, *now.found.ground, options.second.objects, &depth);
      ++num_with_objects;
    }
    if (!options.keeps_completed) depth.confidence.setTo(0, ~(now.measured.value > 0));
    if (callbacks.watcher) callbacks.watcher(view.frame_index, view.world_from_camera, depth);
    store.Put(view.frame_index, depth);
  }
  return num_with_objects;
}

}  // namespace orb360
