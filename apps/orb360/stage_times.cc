#include "apps/orb360/stage_times.h"

#include "nn/base/statistics.h"

namespace orb360 {

void StageTimes::Add(const std::map<std::string, double>& timing_ms) {
  for (const auto& [stage, time] : timing_ms) times_[stage].push_back(time);
}

nlohmann::json StageTimes::Summary() const {
  nlohmann::json summary = nlohmann::json::object();
  for (auto [stage, times] : times_) {
    summary[stage] = {{"median", NearestRankQuantile(times, 0.5)},
                      {"p95", NearestRankQuantile(times, 0.95)}};
  }
  return summary;
}

}  // namespace orb360
