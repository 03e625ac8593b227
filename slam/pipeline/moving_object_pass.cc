#include "slam/pipeline/moving_object_pass.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <utility>

#include "slam/pipeline/view_selection.h"

namespace orb360 {
namespace {

constexpr double kMinError = 0.01;  // of ln(range); only ranges are compared

/// The views that were used last.
class RecentViews {
 public:
  RecentViews(std::span<const DenseView> views, const DepthMapStore& store)
      : views_(views), store_(store) {}

  std::shared_ptr<const DepthView> Get(size_t index) {
    const auto found = std::ranges::find(recent_, index, &Entry::index);
    if (found != recent_.end()) return found->view;
    if (recent_.size() >= kCapacity) recent_.pop_front();
    const DenseView& view = views_[index];
    recent_.push_back(
        {index, std::make_shared<const DepthView>(store_.Get(view.frame_index),
                                                  view.world_from_camera, kMinError)});
    return recent_.back().view;
  }

  void Forget(size_t index) {
    std::erase_if(recent_, [index](const Entry& entry) { return entry.index == index; });
  }

 private:
  static constexpr size_t kCapacity = 48;  // 2.5 MB each for 1024 x 512 pixels

  struct Entry {
    size_t index;
    std::shared_ptr<const DepthView> view;
  };

  std::span<const DenseView> views_;
  const DepthMapStore& store_;
  std::deque<Entry> recent_;
};

}  // namespace

int CorrectMovingObjects(std::span<const DenseView> views, const NeighbourFinder& neighbours_of,
                         const Eigen::Vector3d& up, const MovingObjectPassOptions& options,
                         const DepthMapStore& store, const ViewProgress& progress) {
  RecentViews recent(views, store);
  const auto count = static_cast<int>(views.size());
  int num_views = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    const DenseView& view = views[i];
    if (!store.Contains(view.frame_index)) continue;
    if (progress && !progress(count, count)) break;
    DenseDepth depth = store.Get(view.frame_index);
    const std::optional<DenseGround> ground =
        FindGround(depth, view.world_from_camera.rotation.inverse() * up, options.ground);
    if (!ground) continue;
    const std::shared_ptr<const DepthView> seen = recent.Get(i);
    const cv::Mat below = FindBelowGround(*seen, *ground, options.objects);
    if (cv::countNonZero(below) == 0) continue;
    std::vector<double> distances = options.distances;
    for (double& distance : distances) distance *= std::exp(ground->log_height);
    std::vector<size_t> neighbours = neighbours_of(i);
    std::erase_if(neighbours, [&](size_t n) { return !store.Contains(views[n].frame_index); });
    std::vector<std::shared_ptr<const DepthView>> kept;
    std::vector<const DepthView*> others;
    for (const size_t other :
         ChooseViewsByDistance(views, i, neighbours, distances, options.max_distance_ratio)) {
      kept.push_back(recent.Get(other));
      others.push_back(kept.back().get());
    }
    if (PlaceMovingObjects(below, *seen, *ground, others, options.objects, &depth) == 0) continue;
    ++num_views;
    store.Put(view.frame_index, depth);
    recent.Forget(i);
  }
  return num_views;
}

}  // namespace orb360
