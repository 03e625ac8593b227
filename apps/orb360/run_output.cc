#include "apps/orb360/run_output.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "apps/orb360/saved_views.h"
#include "slam/evaluation/map_plot.h"
#include "slam/io/atomic_file.h"
#include "slam/io/dataset.h"
#include "slam/io/json_text.h"
#include "slam/io/octree/octree_format.h"
#include "slam/io/octree/octree_writer.h"
#include "slam/io/ply.h"
#include "slam/io/scale_file.h"

namespace orb360 {
namespace {

constexpr const char* kJournalName = "trajectory.journal";

/// Creates a folder and its parents. False if it existed. Refuses that of a sequence.
bool Create(const std::filesystem::path& folder) {
  if (IsDataset(folder)) {
    throw UserError(folder.string() +
                    ": has a sequence, whose depth a run would overwrite; choose another folder");
  }
  std::error_code error;
  const bool is_new = std::filesystem::create_directories(folder, error);
  if (error) ThrowWriteError(folder, error.value());
  return is_new;
}

/// Leaves out the frames of earlier runs, whose indices are negative.
std::vector<StampedPose> ToStamped(const std::vector<FramePose>& frames) {
  std::vector<StampedPose> poses;
  poses.reserve(frames.size());
  for (const FramePose& frame : frames) {
    if (frame.index >= 0) poses.push_back({frame.timestamp, frame.world_from_camera});
  }
  return poses;
}

/// Returns the transformation into the world frame of the finished files.
Rigid3 FinalFileWorldFromMap(const Reconstruction& reconstruction) {
  if (reconstruction.frames.empty()) return {};
  return FileWorldFromMap(reconstruction.frames.front().world_from_camera, reconstruction.up);
}

/// Draws the map from above, in the frame of the written files. The more landmarks two keyframes
/// share, the darker is their link.
std::string DrawMap(const Reconstruction& reconstruction, const Rigid3& file_world_from_map) {
  std::vector<Eigen::Vector2d> keyframes;
  std::vector<Eigen::Vector2d> landmarks;
  std::vector<MapLink> links;
  for (const FramePose& frame : reconstruction.keyframes) {
    keyframes.emplace_back((file_world_from_map * frame.world_from_camera.translation).head<2>());
  }
  for (const CloudPoint& point : reconstruction.landmarks)
    landmarks.emplace_back((file_world_from_map * point.position).head<2>());
  constexpr double kDarkest = 200;  // landmarks in common
  for (const CovisibleFrames& pair : reconstruction.covisibility)
    links.push_back({pair.first, pair.second, std::min(1.0, pair.shared / kDarkest)});
  return PlotMap(keyframes, links, landmarks);
}

/// The scale at the keyframes at which something tells it, in the order of time.
std::vector<StampedScale> KnownScales(const Reconstruction& reconstruction) {
  std::vector<StampedScale> scales;
  for (const KeyframeScale& scale : reconstruction.keyframe_scales) {
    if (scale.value > 0) scales.push_back({scale.timestamp, scale.value, scale.sigma});
  }
  std::ranges::sort(scales, {}, &StampedScale::timestamp);
  return scales;
}

}  // namespace

RunOutput::RunOutput(const std::filesystem::path& folder)
    : folder_(folder), is_new_folder_(Create(folder)), journal_(folder / kJournalName) {}

RunOutput::~RunOutput() {
  if (file_world_from_map_) return;
  std::error_code ignored;
  std::filesystem::remove(folder_ / kJournalName, ignored);
  if (is_new_folder_) std::filesystem::remove(folder_, ignored);  // Fails unless it is empty.
}

void RunOutput::Append(double timestamp, const Rigid3& map_from_camera) {
  if (!file_world_from_map_) {
    file_world_from_map_ = given_world_ ? *given_world_ : FileWorldFromMap(map_from_camera);
  }
  journal_.Append({timestamp, *file_world_from_map_ * map_from_camera});
}

Rigid3 RunOutput::WorldOf(const Reconstruction& reconstruction) const {
  return given_world_ ? *given_world_ : FinalFileWorldFromMap(reconstruction);
}

DenseOutput RunOutput::WriteDense(const Reconstruction& reconstruction, const DepthMapStore& store,
                                  DenseFiles files, DenseCloudOptions options) const {
  const std::vector<DenseView> views = MakeDenseViews(
      reconstruction, WorldOf(reconstruction), [&](int index) { return store.Contains(index); });
  options.voxel_size = CloudOptionsFor(reconstruction, options.num_threads).voxel_size;
  if (files.depth) {
    SaveDepth(folder_, store, views);
  } else {
    RemoveSavedDepth(folder_);
  }
  if (files.views) {
    SaveViews(folder_ / kViewsName, store, {options.voxel_size.has_value(), views});
  }
  return WriteDenseOutput(folder_, store, views, options, files.mesh);
}

void RunOutput::Finish(const Reconstruction& reconstruction, const nlohmann::json& summary,
                       const std::optional<DenseOutput>& dense) {
  const Rigid3 file_world_from_map = WorldOf(reconstruction);
  std::vector<ColoredPoint> cloud;
  cloud.reserve(reconstruction.landmarks.size());
  for (const CloudPoint& point : reconstruction.landmarks) {
    cloud.push_back({point.position.cast<float>(), point.color});
  }
  WriteTrajectory(folder_ / "trajectory.txt", ToStamped(reconstruction.frames),
                  file_world_from_map);
  WriteTrajectory(folder_ / "keyframes.txt", ToStamped(reconstruction.keyframes),
                  file_world_from_map);
  WriteScales(folder_ / "scale.txt", KnownScales(reconstruction));
  WritePly(folder_ / (dense ? "landmarks.ply" : "cloud.ply"), cloud, file_world_from_map);
  // Those of an earlier run in the same folder would belong to another cloud.
  if (!dense) RemoveSavedDepth(folder_);
  if (!dense || !dense->mesh) std::filesystem::remove(folder_ / kMeshName);
  if (!dense) std::filesystem::remove(folder_ / kOctreeName);
  if (!dense && !cloud.empty()) WriteOctree(folder_ / kOctreeName, folder_ / "cloud.ply");
  if (!reconstruction.keyframes.empty()) {
    WriteFileAtomically(folder_ / "map.svg", DrawMap(reconstruction, file_world_from_map));
  }
  WriteFileAtomically(folder_ / "summary.json", ToJsonText(summary, 2) + "\n");
  std::filesystem::remove(folder_ / kJournalName);
}

}  // namespace orb360
