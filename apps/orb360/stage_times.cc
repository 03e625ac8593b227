#include "apps/orb360/stage_times.h"

#include <algorithm>
#include <cmath>

namespace orb360 {
namespace {

/// The least value that at least the given fraction of the values does not exceed.
double Quantile(std::vector<double> values, double fraction) {
  const auto rank = static_cast<size_t>(std::ceil(fraction * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<size_t>(rank, 1) - 1);
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace

void StageTimes::Add(const std::map<std::string, double>& timing_ms) {
  for (const auto& [stage, time] : timing_ms) times_[stage].push_back(time);
}

nlohmann::json StageTimes::Summary() const {
  nlohmann::json summary = nlohmann::json::object();
  for (const auto& [stage, times] : times_) {
    summary[stage] = {{"median", Quantile(times, 0.5)}, {"p95", Quantile(times, 0.95)}};
  }
  return summary;
}

}  // namespace orb360
