#include "slam/io/export/frame_selection.h"

#include <algorithm>
#include <cmath>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Returns the median distance of what a frame observes, 0 where it observes nothing.
double MedianRange(const SparseModel& model, const PosedFrame& frame) {
  std::vector<double> ranges;
  ranges.reserve(frame.observations.size());
  for (const PointObservation& seen : frame.observations) {
    ranges.push_back((model.points[static_cast<size_t>(seen.point)].position -
                      frame.world_from_optical.translation)
                         .norm());
  }
  return ranges.empty() ? 0.0 : Median(ranges);
}

}  // namespace

std::vector<double> SurroundingRanges(const SparseModel& model) {
  const size_t count = model.frames.size();
  std::vector<double> ranges(count);
  std::vector<size_t> known;  // frames with a range of their own
  std::vector<double> all;
  for (size_t f = 0; f < count; ++f) {
    ranges[f] = MedianRange(model, model.frames[f]);
    if (!(ranges[f] > 0)) continue;
    known.push_back(f);
    all.push_back(ranges[f]);
  }
  if (known.empty()) return std::vector<double>(count, 1.0);
  size_t next = 0;  // of the known ones, the first at or after the frame
  for (size_t f = 0; f < count; ++f) {
    while (next < known.size() && known[next] < f) ++next;
    if (next < known.size() && known[next] == f) continue;
    const auto time = [&](size_t frame) { return model.frames[frame].timestamp; };
    const bool is_next_nearer =
        next == 0 ||
        (next < known.size() && time(known[next]) - time(f) < time(f) - time(known[next - 1]));
    ranges[f] = ranges[is_next_nearer ? known[next] : known[next - 1]];
  }
  return ranges;
}

std::vector<bool> SelectSharpest(const SparseModel& model, std::span<const double> sharpness,
                                 double spacing) {
  const size_t count = model.frames.size();
  ORB360_CHECK(sharpness.size() == count && spacing > 0, sharpness.size(), count, spacing);
  const std::vector<double> ranges = SurroundingRanges(model);
  std::vector<bool> is_selected(count, false);
  if (count == 0) return is_selected;
  const auto distance = [&](size_t from, size_t to) {
    return (model.frames[to].world_from_optical.translation -
            model.frames[from].world_from_optical.translation)
               .norm() /
           (spacing * ranges[from]);
  };
  const auto sharpest = [&](size_t begin, size_t end) {
    return static_cast<size_t>(
        std::max_element(sharpness.begin() + static_cast<std::ptrdiff_t>(begin),
                         sharpness.begin() + static_cast<std::ptrdiff_t>(end)) -
        sharpness.begin());
  };
  size_t end = 1;
  while (end < count && distance(0, end) < 0.5) ++end;
  size_t selected = sharpest(0, end);
  is_selected[selected] = true;
  while (true) {
    size_t begin = selected + 1;
    while (begin < count && distance(selected, begin) < 0.5) ++begin;
    if (begin == count) break;
    end = begin + 1;
    while (end < count && distance(selected, end) >= 0.5 && distance(selected, end) <= 1.5) ++end;
    selected = sharpest(begin, end);
    is_selected[selected] = true;
  }
  return is_selected;
}

}  // namespace orb360
