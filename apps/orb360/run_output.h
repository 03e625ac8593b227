#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "apps/orb360/dense_output.h"
#include "slam/io/trajectory_journal.h"
#include <orb360/slam/io/trajectory.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// The folder into which a run writes. During the run it contains `trajectory.journal`, with each
/// pose as it was first known. At the end the finished files replace the journal.
class RunOutput {
 public:
  /// Creates the folder if it does not exist and starts the journal. Throws UserError where that
  /// fails.
  explicit RunOutput(const std::filesystem::path& folder);
  /// Removes a journal without a pose, and the folder if it was created for this run.
  ~RunOutput();
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  /// Sets the world frame of the files, which is otherwise that of the first pose.
  void SetWorld(const Rigid3& file_world_from_map) { given_world_ = file_world_from_map; }

  /// Adds a pose to the journal; `timestamp` is in seconds. Unless SetWorld has been called, the
  /// world frame of the journal is that of the first pose, which is not levelled.
  void Append(double timestamp, const Rigid3& map_from_camera);

  /// Returns the transformation from the map into the world of the finished files.
  Rigid3 WorldOf(const Reconstruction& reconstruction) const;

  /// What WriteDense writes beside the cloud.
  struct DenseFiles {
    bool depth = false;  ///< The ranges of the views (SaveDepth).
    bool views = false;  ///< All that the cloud is made of (SaveViews).
    bool mesh = false;   ///< The surface through the cloud (MeshWriter).
  };
  /// Writes cloud.ply, the dense cloud of the views in the store, fused with `options` and
  /// voxels as CloudOptionsFor chooses them.
  DenseOutput WriteDense(const Reconstruction& reconstruction, const DepthMapStore& store,
                         DenseFiles files, DenseCloudOptions options) const;

  /// Writes trajectory.txt, keyframes.txt, scale.txt, the landmarks as cloud.ply (as landmarks.ply
  /// where there is a dense cloud) with an octree, map.svg (where there is a keyframe) and
  /// summary.json, then removes the journal.
  void Finish(const Reconstruction& reconstruction, const nlohmann::json& summary,
              const std::optional<DenseOutput>& dense);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  const std::filesystem::path folder_;
  const bool is_new_folder_;
  TrajectoryJournal journal_;
  std::optional<Rigid3> given_world_;
  /// The world of the journal's poses, known from the first pose on.
  std::optional<Rigid3> file_world_from_map_;
};

}  // namespace orb360
