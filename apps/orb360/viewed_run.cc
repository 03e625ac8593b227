#include "apps/orb360/viewed_run.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/orb360/input.h"
#include "apps/orb360/run_octree.h"
#include "apps/orb360/saved_views.h"
#include "slam/io/octree/octree_file.h"
#include "slam/io/optical_frame.h"
#include "slam/io/ply.h"
#include "slam/io/sparse_model_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/sequence.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

/// The frames of a run that has no reconstruction, as its trajectories tell them. Their indices in
/// the input are unknown; numbers in order stand for them.
SparseModel ModelOfTrajectories(const std::filesystem::path& folder) {
  SparseModel model;
  if (!std::filesystem::exists(folder / "trajectory.txt")) return model;
  std::vector<double> keyframe_times;
  if (std::filesystem::exists(folder / "keyframes.txt")) {
    for (const StampedPose& pose : ReadTrajectory(folder / "keyframes.txt")) {
      keyframe_times.push_back(pose.timestamp);
    }
  }
  std::ranges::sort(keyframe_times);
  for (const StampedPose& pose : ReadTrajectory(folder / "trajectory.txt")) {
    PosedFrame frame;
    frame.index = static_cast<int>(model.frames.size());
    frame.timestamp = pose.timestamp;
    frame.is_keyframe = std::ranges::binary_search(keyframe_times, pose.timestamp);
    frame.world_from_optical = WorldFromOptical(pose.world_from_camera);
    model.frames.push_back(frame);
  }
  return model;
}

/// The keyframes whose images can be read again one by one: those of a folder of images. A video
/// would have to be decoded up to each of them.
std::vector<int> FindImages(const nlohmann::json& summary, const SparseModel& model) {
  std::vector<int> frames;
  if (!std::filesystem::is_directory(summary.value("input", ""))) return frames;
  for (const PosedFrame& frame : model.frames) {
    if (frame.is_keyframe) frames.push_back(frame.index);
  }
  return frames;
}

/// The frames whose depth was saved, and why there are none.
std::vector<int> FindViews(const std::filesystem::path& folder, const SparseModel& model,
                           bool has_images, std::vector<std::string>* missing) {
  if (!std::filesystem::exists(folder / kViewsName)) {
    missing->push_back(has_images
                           ? "Ranges of keyframes: the run did not keep them. `orb360 run "
                             "--save-views` does."
                           : "Images and ranges of keyframes: the run did not keep them. `orb360 "
                             "run --save-views` does.");
    return {};
  }
  std::vector<int> frames;
  try {
    frames = FramesWithDepth(folder / kViewsName, model);
  } catch (const UserError& error) {
    missing->push_back(std::string("Images and ranges of keyframes: ") + error.what() + ".");
    return {};
  }
  if (frames.empty()) {
    missing->push_back(
        "Images and ranges of keyframes: those in `views` belong to an earlier run. Run it again "
        "with `--save-views`.");
  }
  return frames;
}

}  // namespace

nlohmann::json ReadSummaryJson(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw UserError(folder.string() + ": is no folder; give that of a finished `orb360 run`");
  }
  const std::filesystem::path path = folder / "summary.json";
  std::ifstream file(path);
  if (!file) {
    throw UserError(folder.string() +
                    ": holds no finished run (there is no summary.json); `orb360 run INPUT --out "
                    "DIR` makes one");
  }
  try {
    nlohmann::json summary = nlohmann::json::parse(file);
    // What is read below and by the page's scene throws here if it has another type.
    summary.value("input", "");
    summary.value("lens", "");
    HasMetres(summary);
    return summary;
  } catch (const nlohmann::json::exception&) {  // The message below says what to do.
  }
  throw UserError(path.string() + ": is damaged; run `orb360 run` again");
}

ViewedRun OpenViewedRun(const std::filesystem::path& folder, bool is_quiet) {
  ViewedRun run;
  RunScene& scene = run.scene;
  scene.summary = ReadSummaryJson(folder);
  scene.folder = folder.lexically_normal().string();
  std::vector<std::string>& missing = scene.missing;
  if (std::filesystem::exists(folder / kSparseModelName)) {
    scene.model = ReadSparseModel(folder / kSparseModelName);
    scene.images = FindImages(scene.summary, scene.model);
    scene.views = FindViews(folder, scene.model, !scene.images.empty(), &missing);
    run.views = folder / kViewsName;
  } else {
    try {
      scene.model = ModelOfTrajectories(folder);
    } catch (const UserError& error) {
      missing.push_back(std::string("Trajectory: ") + error.what() + ".");
    }
    missing.push_back(
        "Keyframe graph, images and ranges: an older orb360 made this run, without "
        "reconstruction.h5. Run it again to see them.");
  }
  if (scene.model.frames.empty()) missing.push_back("Trajectory: no frame of this run has a pose.");
  if (std::filesystem::exists(folder / "scale.txt"))
    scene.scales = ReadScales(folder / "scale.txt");
  if (const auto octree = ProvideOctree(folder, is_quiet, &missing)) {
    const OctreeFile checked(*octree);
    if ((checked.header().attributes & kOctreeConfidences) == 0) {
      missing.push_back(
          "Dense cloud: the run made none (`--weights none`, or too little motion), so the points "
          "are its landmarks, without confidence.");
    }
    run.octree = *octree;
    scene.has_cloud = true;
    scene.voxel_size = VoxelSizeOf(folder / "cloud.ply");
  }
  return run;
}

cv::Mat LoadInputImage(const ViewedRun& run, int frame) {
  const std::string input = run.scene.summary.value("input", "");
  SequenceOptions options;
  options.only = {frame};
  options.lens = run.scene.summary.value("lens", "");
  if (const std::optional<Frame> read = OpenInput(input, options)->Next()) return read->image;
  throw UserError(input + ": has no frame " + std::to_string(frame) + " any more");
}

}  // namespace orb360
