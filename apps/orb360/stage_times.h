#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace orb360 {

/// The wall times of a run's stages, frame by frame.
class StageTimes {
 public:
  /// Milliseconds by stage, of one frame.
  void Add(const std::map<std::string, double>& timing_ms);

  /// {"stage": {"median": ms, "p95": ms}, ...}; the p95 is the least time that 95 % of the frames
  /// do not exceed.
  nlohmann::json Summary() const;

 private:
  std::map<std::string, std::vector<double>> times_;
};

}  // namespace orb360
