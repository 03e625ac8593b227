#include "apps/orb360/run_output.h"

#include <string>
#include <system_error>
#include <vector>

#include "slam/io/atomic_file.h"
#include "slam/io/ply.h"

namespace orb360 {
namespace {

constexpr const char* kJournalName = "trajectory.journal";

/// Creates a folder and those above it; false if it was there.
bool Create(const std::filesystem::path& folder) {
  std::error_code error;
  const bool is_new = std::filesystem::create_directories(folder, error);
  if (error) ThrowWriteError(folder, error.value());
  return is_new;
}

std::vector<StampedPose> ToStamped(const std::vector<FramePose>& frames) {
  std::vector<StampedPose> poses;
  poses.reserve(frames.size());
  for (const FramePose& frame : frames) poses.push_back({frame.timestamp, frame.world_from_camera});
  return poses;
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
  if (!file_world_from_map_) file_world_from_map_ = FileWorldFromMap(map_from_camera);
  journal_.Append({timestamp, *file_world_from_map_ * map_from_camera});
}

void RunOutput::Finish(const Reconstruction& reconstruction, const nlohmann::json& summary) {
  Rigid3 file_world_from_map;
  if (!reconstruction.frames.empty()) {
    file_world_from_map =
        FileWorldFromMap(reconstruction.frames.front().world_from_camera, reconstruction.up);
  }
  std::vector<ColoredPoint> cloud;
  cloud.reserve(reconstruction.landmarks.size());
  for (const CloudPoint& point : reconstruction.landmarks) {
    cloud.push_back({point.position.cast<float>(), point.color});
  }
  WriteTrajectory(folder_ / "trajectory.txt", ToStamped(reconstruction.frames),
                  file_world_from_map);
  WriteTrajectory(folder_ / "keyframes.txt", ToStamped(reconstruction.keyframes),
                  file_world_from_map);
  WritePly(folder_ / "cloud.ply", cloud, file_world_from_map);
  WriteFileAtomically(folder_ / "summary.json", summary.dump(2) + "\n");
  std::filesystem::remove(folder_ / kJournalName);
}

}  // namespace orb360
