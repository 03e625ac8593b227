#include "apps/orb360/compared_run.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/orb360/run_octree.h"
#include "slam/io/dataset.h"
#include "slam/io/octree/octree_file.h"
#include "slam/viewer/comparison.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

ComparedPath ReadComparedPath(const std::filesystem::path& path) {
  ComparedPath other;
  other.name = path.lexically_normal().string();
  if (!std::filesystem::exists(path)) {
    throw UserError(path.string() + ": no such file or folder; --compare takes another run, the " +
                    "folder of a sequence with ground truth, or a TUM trajectory");
  }
  std::filesystem::path file = path;
  if (std::filesystem::exists(path / "summary.json")) {
    other.has_metres = HasMetres(ReadSummaryJson(path));
    file = path / "trajectory.txt";
  } else {
    other.is_truth = true;
    if (std::filesystem::is_directory(path)) file = path / Dataset::kGroundTruthName;
    if (!std::filesystem::exists(file)) {
      throw UserError(path.string() + ": holds neither a finished run (summary.json) nor ground " +
                      "truth (" + Dataset::kGroundTruthName + "), of which --compare needs one");
    }
  }
  other.poses = ReadTrajectory(file);
  return other;
}

}  // namespace

void CompareWith(const std::filesystem::path& other, ViewedRun* run) {
  const ComparedPath path = ReadComparedPath(other);
  RunScene& scene = run->scene;
  std::vector<StampedPose> poses;  // Only their positions matter, which every camera frame has.
  for (const PosedFrame& frame : scene.model.frames) {
    poses.push_back({frame.timestamp, frame.world_from_optical});
  }
  scene.comparison = ComparePaths(poses, HasMetres(scene.summary), path);
  if (!scene.comparison) {
    throw UserError(other.string() + ": cannot be aligned with " + scene.folder +
                    ": at least three of its " + std::to_string(path.poses.size()) +
                    " poses, in different places, must be within 20 ms of poses of the run");
  }
}

void AddOtherCloud(const std::filesystem::path& other, ViewedRun* run) {
  RunScene& scene = run->scene;
  if (scene.comparison->other.is_truth) return;
  std::vector<std::string> missing;
  const std::optional<std::filesystem::path> octree = ProvideOctree(other, false, &missing);
  if (!octree) {
    scene.missing.push_back("Cloud of " + scene.comparison->other.name +
                            ": it has none that can be shown.");
    return;
  }
  const OctreeFile checked(*octree);
  run->other_octree = *octree;
  scene.has_other_cloud = true;
}

}  // namespace orb360
