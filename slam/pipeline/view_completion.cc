#include "slam/pipeline/view_completion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <utility>

#include "slam/depth/dense_ground.h"
#include "slam/depth/ground_points.h"
#include "slam/depth/occluding_boundary.h"
#include "slam/pipeline/fifo_cache.h"
#include "slam/pipeline/view_ranges.h"
#include "slam/pipeline/view_selection.h"

namespace orb360 {
namespace {

constexpr double kMinError = 0.01;  // of ln(range); a measured pixel is told from others by more
// Mean error of the range beside the edge of a near surface (docs/results/stereo.md). It stays in
// the depth, but not in the cloud.
constexpr double kBoundaryError = 0.16;
// Where the network expects a larger relative error it may see the sky, of which it is trained to
// state 1. It gives that the range of the roofs around it.
constexpr double kSkyError = 0.5;

constexpr size_t kRecentViews = 48;  // 4 MB each for 1024 x 512 pixels

/// Views of the first pass, which live as long as this.
using LoadedViews = std::vector<std::shared_ptr<const DepthView>>;

std::vector<const DepthView*> PointersTo(const LoadedViews& loaded) {
  std::vector<const DepthView*> views;
  for (const auto& view : loaded) views.push_back(view.get());
  return views;
}

cv::Size SizeOf(const EquirectangularCamera& camera) { return {camera.width(), camera.height()}; }

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
  return {FindMovingObjects(below, view, *ground, PointersTo(others), options.objects), ground};
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
        depths_(kRecentViews,
                [this](size_t i) {
                  return std::make_shared<const DepthView>(first_.Get(views_[i].frame_index),
                                                           views_[i].world_from_camera, kMinError);
                }),
        colors_(kRecentViews, [this](size_t i) {
          return SurfaceColors(images_.Get(views_[i].frame_index), SizeOf(camera_));
        }) {}
  ViewPreparation(const ViewPreparation&) = delete;
  ViewPreparation& operator=(const ViewPreparation&) = delete;

  PreparedView Prepare(size_t i, bool is_interrupted) {
    const DenseView& view = views_[i];
    const ViewCompletionOptions& second = options_.second;
    const bool has_stereo = !options_.baselines.empty();
    DenseDepth depth = first_.Get(view.frame_index);
    InverseRanges measured = has_stereo ? MeasuredOf(depth) : NothingMeasured(depth.range.size());
    std::vector<size_t> neighbours = neighbours_of_(i);
    std::erase_if(neighbours, [&](size_t n) { return !first_.Contains(views_[n].frame_index); });
    const auto choose = [&](std::vector<double> distances, double unit) {
      for (double& distance : distances) distance *= unit;
      return ChooseViewsByDistance(views_, i, neighbours, distances, second.max_distance_ratio);
    };
    ObjectsOnGround found;
    if (up_ && !is_interrupted) {
      found = FindObjects(depth, *depths_.Get(i), *up_, second, [&](double height) {
        LoadedViews loaded;
        for (const size_t other : choose(second.ground_distances, height)) {
          loaded.push_back(depths_.Get(other));
        }
        return loaded;
      });
    }
    const cv::Mat moving = MaskOf(found.objects, depth.range.size());
    measured.value.setTo(0, moving);
    SparseDepth sparse = RenderSparseDepth(landmarks_of_(view), camera_);
    SampleSquares(measured, options_.sparse_spacing, 0, options_.sparse, &sparse);
    const bool is_completed = has_stereo && !is_interrupted;
    const cv::Mat color = images_.Get(view.frame_index);
    if (is_completed) {
      const double range = TrustedRange(depth, options_.min_trusted_confidence);
      AddPointsOf(choose(second.distances, range), view, color, &sparse);
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
            .color = color,
            .is_completed = is_completed};
  }

 private:
  void AddPointsOf(std::span<const size_t> others, const DenseView& view, const cv::Mat& color,
                   SparseDepth* sparse) {
    LoadedViews depths;
    std::vector<cv::Mat> colors;
    for (const size_t other : others) {
      depths.push_back(depths_.Get(other));
      colors.push_back(colors_.Get(other));
    }
    std::vector<SeenView> seen;
    for (size_t k = 0; k < depths.size(); ++k) seen.push_back({depths[k].get(), &colors[k]});
    AddReprojectedPoints(view.world_from_camera, SurfaceColors(color, SizeOf(camera_)), seen,
                         {.spacing = options_.sparse_spacing, .sparse = options_.sparse}, sparse,
                         num_threads_);
  }

  std::span<const DenseView> views_;
  const NeighbourFinder& neighbours_of_;
  const LandmarkProjector& landmarks_of_;
  const std::optional<Eigen::Vector3d>& up_;
  const ViewDepthOptions& options_;
  const ImageStore& images_;
  const EquirectangularCamera& camera_;
  int num_threads_;
  const DepthMapStore& first_;
  FifoCache<std::shared_ptr<const DepthView>> depths_;
  FifoCache<cv::Mat> colors_;  // SurfaceColors
};

/// Completes a view by the network, and keeps what was measured.
void Complete(const PreparedView& view, const ViewDepthOptions& options, DepthCompleter* completer,
              DenseDepth* depth) {
  *depth = completer->Complete(view.color, view.sparse);
  cv::Mat surfaces = depth->range.clone();
  surfaces.setTo(std::numeric_limits<float>::infinity(), depth->confidence < 1 / (1 + kSkyError));
  StateCompleted(options.completed_error_factor, depth);
  PutMeasured(view.measured, depth);
  depth->range.copyTo(surfaces, view.measured.value > 0);
  StateBoundary(FindOccludingBoundary(surfaces), kBoundaryError, depth);
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
