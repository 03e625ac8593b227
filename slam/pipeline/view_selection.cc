#include "slam/pipeline/view_selection.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace orb360 {

double DistanceBetween(const DenseView& a, const DenseView& b) {
  return (a.world_from_camera.translation - b.world_from_camera.translation).norm();
}

std::vector<size_t> ChooseViewsByDistance(std::span<const DenseView> views, size_t reference,
                                          std::span<const size_t> neighbours,
                                          std::span<const double> distances, double max_ratio) {
  std::vector<size_t> chosen;
  for (const double wanted : distances) {
    for (const bool is_after : {false, true}) {
      std::optional<size_t> best;
      double least = std::log(max_ratio);
      for (const size_t i : neighbours) {
        if ((i > reference) != is_after || std::ranges::find(chosen, i) != chosen.end()) continue;
        const double distance = DistanceBetween(views[i], views[reference]);
        if (!(distance > 0)) continue;
        const double difference = std::abs(std::log(distance / wanted));
        if (difference >= least) continue;
        least = difference;
        best = i;
      }
      if (best) chosen.push_back(*best);
    }
  }
  return chosen;
}

}  // namespace orb360
