#include "slam/depth/dense_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Distances at which keyframes are compared, as fractions of the median range: from views that see
/// nearly the same pixels to views from which half of the scene is hidden.
constexpr double kDistances[] = {0.125, 0.25, 0.5, 1.0, 2.0};

/// A view with the data that a comparison needs.
struct LoadedView {
  DepthView depth;
  double median_range;  // world units
  cv::Mat color;        // CV_8UC3
};

/// The views that were used most recently.
class ViewCache {
 public:
  ViewCache(std::span<const DenseView> views, const DepthLoader& load,
            const GeometricConsistencyOptions& options, size_t capacity)
      : views_(views), load_(load), options_(options), capacity_(capacity) {}

  std::shared_ptr<const LoadedView> Get(size_t index) {
    auto found = entries_.find(index);
    if (found == entries_.end()) {
      if (entries_.size() >= capacity_) {
        entries_.erase(std::ranges::min_element(
            entries_, {}, [](const auto& entry) { return entry.second.used; }));
      }
      found = entries_.emplace(index, Entry{Load(index), 0}).first;
    }
    found->second.used = ++now_;
    return found->second.view;
  }

 private:
  struct Entry {
    std::shared_ptr<const LoadedView> view;
    std::int64_t used;
  };

  std::shared_ptr<const LoadedView> Load(size_t index) const {
    const DenseView& view = views_[index];
    const DenseDepth depth = load_(view.frame_index);
    return std::make_shared<LoadedView>(
        LoadedView{DepthView(depth, view.world_from_camera, options_.min_error),
                   MedianRange(depth.range), depth.color});
  }

  std::span<const DenseView> views_;
  const DepthLoader& load_;
  const GeometricConsistencyOptions& options_;
  const size_t capacity_;
  std::map<size_t, Entry> entries_;
  std::int64_t now_ = 0;
};

/// A view and its source views.
struct Comparison {
  std::shared_ptr<const LoadedView> view;
  std::vector<std::shared_ptr<const LoadedView>> others;
};

}  // namespace

double ChooseVoxelSize(std::span<const DenseView> views, const DepthLoader& load) {
  constexpr size_t kSamples = 15;
  std::vector<double> medians;
  const size_t step = views.size() / kSamples + 1;
  for (size_t i = 0; i < views.size(); i += step) {
    const double median = MedianRange(load(views[i].frame_index).range);
    if (median > 0) medians.push_back(median);
  }
  if (medians.empty()) return 1.0;  // There will be no point.
  return 0.01 * Median(medians);
}

double MedianRange(const cv::Mat& range) {
  ORB360_CHECK(range.type() == CV_32FC1, range.type());
  // The number of pixels taken from a row is proportional to its solid angle.
  std::vector<float> ranges;
  for (int row = 0; row < range.rows; ++row) {
    const double latitude = std::numbers::pi * (0.5 - (row + 0.5) / range.rows);
    const int step = std::max(1, static_cast<int>(std::lround(1.0 / std::cos(latitude))));
    for (int column = 0; column < range.cols; column += step) {
      const float value = range.at<float>(row, column);
      if (value > 0) ranges.push_back(value);
    }
  }
  return ranges.empty() ? 0.0 : Median(ranges);
}

std::vector<size_t> ChooseNeighbours(std::span<const DenseView> views, size_t view,
                                     double median_range, int max_neighbours) {
  struct Candidate {
    size_t index;
    double distance;  // logarithm of the ratio to the median range
  };
  std::vector<Candidate> sides[2];  // before and after the view
  for (const size_t index : views[view].neighbours) {
    ORB360_CHECK(index < views.size() && index != view, index, view, views.size());
    const double distance =
        (views[index].world_from_camera.translation - views[view].world_from_camera.translation)
            .norm();
    if (distance > 0) {
      sides[index > view].push_back({index, std::log(distance / median_range)});
    }
  }
  std::vector<size_t> chosen;
  // The middle one comes first, because it is the best where fewer are wanted.
  for (const int at : {2, 3, 1, 4, 0}) {
    for (std::vector<Candidate>& side : sides) {
      if (side.empty() || static_cast<int>(chosen.size()) >= max_neighbours) continue;
      const double wanted = std::log(kDistances[at]);
      const auto best = std::ranges::min_element(side, {}, [wanted](const Candidate& c) {
        return std::pair(std::abs(c.distance - wanted), c.index);
      });
      chosen.push_back(best->index);
      side.erase(best);
    }
  }
  std::ranges::sort(chosen);
  return chosen;
}

DenseCloudStatistics FuseCloud(std::span<const DenseView> views, const DepthLoader& load,
                               const DenseCloudOptions& options, const VoxelSink& sink) {
  DenseCloudStatistics statistics;
  statistics.voxel_size = options.voxel_size ? *options.voxel_size : ChooseVoxelSize(views, load);
  ORB360_CHECK(statistics.voxel_size > 0, statistics.voxel_size);
  ORB360_CHECK(options.max_neighbours >= 0 && options.max_views > options.max_neighbours,
               options.max_neighbours, options.max_views);
  const SamplingOptions sampling{statistics.voxel_size,
                                 options.max_range_voxels * statistics.voxel_size,
                                 options.max_error_voxels * statistics.voxel_size};
  ViewCache cache(views, load, options.consistency, static_cast<size_t>(options.max_views));
  VoxelGrid grid(statistics.voxel_size);
  const auto prepare = [&](size_t index) {
    Comparison comparison{cache.Get(index), {}};
    const double median_range = comparison.view->median_range;
    if (!(median_range > 0)) return comparison;
    for (const size_t other :
         ChooseNeighbours(views, index, median_range, options.max_neighbours)) {
      comparison.others.push_back(cache.Get(other));
    }
    return comparison;
  };
  const auto compare_next = [&] {
    if (options.progress) options.progress(0, static_cast<int>(views.size()));
  };
  const std::vector<Eigen::Array3f> gains =
      options.exposure ? EstimateGains(views, load, *options.exposure, compare_next)
                       : std::vector<Eigen::Array3f>(views.size(), Eigen::Array3f::Ones());
  const auto collect = [&](const std::vector<ConsistentPoint>& points, const cv::Mat& color,
                           size_t index) {
    std::vector<VoxelSample> samples;
    samples.reserve(points.size());
    for (const ConsistentPoint& point : points) {
      const cv::Vec3b& bgr = color.at<cv::Vec3b>(point.row, point.column);
      std::array<std::uint8_t, 3> rgb{};
      for (int i = 0; i < 3; ++i) {
        rgb[2 - i] = cv::saturate_cast<std::uint8_t>(gains[index][i] * static_cast<float>(bgr[i]));
      }
      samples.push_back({point.position, point.normal, rgb, point.error});
    }
    grid.Add(samples, static_cast<int>(index));
    if (grid.num_voxels() > options.max_voxels) sink(grid.TakeOldest());
  };
  // While one view is compared, the files of the next one are read and the points of the previous
  // one are collected. Each of the three steps handles the views in their order. These variables
  // are declared last, so that if a function throws they wait for threads that use all of the
  // above.
  std::future<Comparison> next;
  std::future<void> collecting;
  for (size_t i = 0; i < views.size(); ++i) {
    if (options.progress) options.progress(static_cast<int>(i), static_cast<int>(views.size()));
    const Comparison now = next.valid() ? next.get() : prepare(i);
    if (i + 1 < views.size()) next = std::async(std::launch::async, prepare, i + 1);
    if (!(now.view->median_range > 0)) continue;
    ++statistics.views;
    std::vector<const DepthView*> others;
    for (const auto& other : now.others) others.push_back(&other->depth);
    std::vector<ConsistentPoint> points = FindConsistentPoints(
        now.view->depth, others, options.consistency, sampling, options.num_threads);
    statistics.consistent += static_cast<std::int64_t>(points.size());
    if (collecting.valid()) collecting.get();
    collecting = std::async(std::launch::async, collect, std::move(points), now.view->color, i);
  }
  if (collecting.valid()) collecting.get();
  sink(grid.TakeAll());
  return statistics;
}

}  // namespace orb360
