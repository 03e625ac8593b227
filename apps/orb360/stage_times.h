#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace orb360 {

/// The wall times of the stages of a run, for every frame.
class StageTimes {
 public:
  /// Adds the wall times of one frame, ms by stage.
  void Add(const std::map<std::string, double>& timing_ms);

  /// Returns {"stage": {"median": ms, "p95": ms}, ...}. The p95 is the least time that 95 % of the
  /// frames do not exceed.
  nlohmann::json Summary() const;

 private:
  std::map<std::string, std::vector<double>> times_;
};

}  // namespace orb360
