#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "apps/orb360/dense_output.h"
#include "slam/io/trajectory.h"
#include "slam/io/trajectory_journal.h"
#include "slam/pipeline/reconstruction.h"

namespace orb360 {

/// The folder a run writes into. While the run lasts it holds `trajectory.journal`, each pose as
/// it is first known; at the end the finished files take its place.
class RunOutput {
 public:
  /// Creates the folder if need be and begins the journal. Throws UserError where that fails.
  explicit RunOutput(const std::filesystem::path& folder);
  /// Removes a journal without a pose, and the folder if it was made for that.
  ~RunOutput();
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  /// Files are written in this world instead of that of the first pose.
  void SetWorld(const Rigid3& file_world_from_map) { given_world_ = file_world_from_map; }

  /// Adds to the journal. Its world is that of the first pose, not levelled, unless one is given.
  void Append(double timestamp, const Rigid3& map_from_camera);

  /// Writes the dense cloud of the keyframes in the store, cloud.ply, and with `saves_depth` their
  /// ranges (SaveDepth).
  DenseOutput WriteDense(const Reconstruction& reconstruction, const DepthMapStore& store,
                         bool saves_depth, int num_threads) const;

  /// Writes trajectory.txt, keyframes.txt, the landmarks as cloud.ply (as landmarks.ply where there
  /// is a dense cloud), map.svg (where there is a keyframe), summary.json and the report
  /// (WriteRunReport), then removes the journal. Returns the world of the files from the map's.
  Rigid3 Finish(const Reconstruction& reconstruction, const nlohmann::json& summary,
                const std::optional<DenseOutput>& dense);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  Rigid3 WorldOf(const Reconstruction& reconstruction) const;

  const std::filesystem::path folder_;
  const bool is_new_folder_;
  TrajectoryJournal journal_;
  std::optional<Rigid3> given_world_;
  std::optional<Rigid3> file_world_from_map_;  // of the journal, from its first pose on
};

}  // namespace orb360
