#include "slam/depth/geometric_consistency.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/depth/source_view.h"
#include "slam/depth/surface_normals.h"
#include "slam/depth/tested_row.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Selects the pixels of a row that are tested.
void ChoosePixels(const DepthView& view, int row, const SamplingOptions& sampling,
                  float max_own_error, TestedRow* points) {
  const float pixel_angle = std::numbers::pi_v<float> / static_cast<float>(view.height());
  points->Clear(row);
  const int step = ColumnStep(std::cos(std::numbers::pi * (0.5 - (row + 0.5) / view.height())));
  for (int column = 0; column < view.width(); column += step) {
    const float range = view.range(row, column);
    if (!(range > 0) || range > sampling.max_range) continue;
    if (range * view.error(row, column) * kMinIncidence > max_own_error) continue;
    // The largest power of two at which pixels are no farther apart than the spacing.
    int stride = 1;
    while (stride < view.height() &&
           2.0f * static_cast<float>(stride) * range * pixel_angle <= sampling.spacing) {
      stride *= 2;
    }
    if (row % stride != 0 || column / step % stride != 0) continue;
    points->Add(column, view.BearingOf(row, column), range);
  }
  points->Close();
}

/// Computes what each point's own keyframe knows of it. Points without a normal, or with an error
/// larger than `max_own_error`, get no variance.
void Weigh(const DepthView& view, float max_own_error, TestedRow* points) {
  for (size_t i = 0; i < points->size; ++i) {
    const auto& [bx, by, bz] = points->bearing;
    const auto& [nx, ny, nz] = points->normal;
    const float slant = bx[i] * nx[i] + by[i] * ny[i] + bz[i] * nz[i];
    if (!(slant < 0)) continue;
    const float error = points->range[i] * view.error(points->row, points->column[i]) *
                        std::max(-slant, kMinIncidence);
    if (error > max_own_error) continue;
    points->variance[i] = error * error;
    points->information[i] = points->best[i] = 1.0f / points->variance[i];
  }
}

}  // namespace

std::vector<ConsistentPoint> FindConsistentPoints(const DepthView& view,
                                                  std::span<const DepthView* const> others,
                                                  const GeometricConsistencyOptions& options,
                                                  const SamplingOptions& sampling,
                                                  int num_threads) {
  ORB360_CHECK(sampling.spacing > 0, sampling.spacing);
  const Rigid3& world_from_view = view.world_from_camera();
  // A point keeps at least this fraction of its own error. A single source view may be more certain
  // by the first factor (in variance), and all views together may be more certain than the best one
  // by the second factor.
  const double redundant_ratio = std::max(options.redundant_ratio, 1.0);
  const auto least_gain =
      static_cast<float>(1 / std::sqrt(redundant_ratio * std::max(options.max_independent, 1.0)));
  const float max_own_error = static_cast<float>(sampling.max_error) / least_gain;

  std::vector<SourceView> sources;
  for (const DepthView* other : others) {
    sources.push_back({other, other->world_from_camera().Inverse() * world_from_view,
                       options.tolerance_errors, options.relative_tolerance, max_own_error});
  }

  const auto collect = [&](const TestedRow& points, std::vector<ConsistentPoint>* consistent) {
    for (size_t i = 0; i < points.size; ++i) {
      if (points.variance[i] == 0) continue;
      const float support = points.support[i];
      const float conflict = points.conflict[i];
      if (support < static_cast<float>(options.min_support)) continue;
      if (conflict > options.max_conflict_fraction * (support + conflict)) continue;
      if (points.best[i] * points.variance[i] > redundant_ratio) continue;
      const float information = std::min(
          points.information[i], static_cast<float>(options.max_independent) * points.best[i]);
      const float error = 1.0f / std::sqrt(information);
      if (error > sampling.max_error) continue;
      const Eigen::Vector3f normal(points.normal[0][i], points.normal[1][i], points.normal[2][i]);
      const Eigen::Vector3f bearing(points.bearing[0][i], points.bearing[1][i],
                                    points.bearing[2][i]);
      const Eigen::Vector3f point =
          points.range[i] * bearing + points.shift[i] / points.information[i] * normal;
      consistent->push_back({world_from_view * point.cast<double>(),
                             (world_from_view.rotation * normal.cast<double>()).cast<float>(),
                             error, points.row, points.column[i]});
    }
  };

  std::vector<std::vector<ConsistentPoint>> rows(static_cast<size_t>(view.height()));
#pragma omp parallel num_threads(num_threads)
  {
    TestedRow points;
#pragma omp for schedule(dynamic, 8)
    for (int row = 0; row < view.height(); ++row) {
      ChoosePixels(view, row, sampling, max_own_error, &points);
      if (points.size == 0) continue;
      FitNormals(view, &points);
      Weigh(view, max_own_error, &points);
      for (const SourceView& source : sources) CompareWithSourceView(source, &points);
      collect(points, &rows[static_cast<size_t>(row)]);
    }
  }
  std::vector<ConsistentPoint> points;
  for (const std::vector<ConsistentPoint>& row : rows) {
    points.insert(points.end(), row.begin(), row.end());
  }
  return points;
}

}  // namespace orb360
