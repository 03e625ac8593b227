#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "benchmarks/slam/sequence_folder.h"
#include "slam/depth/depth_view.h"
#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/io/depth_image.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// A view of a run, in metres.
struct RunView {
  int index;  ///< Of its frame in the sequence.
  DenseDepth depth;
  DepthView view;
};

/// Reads the views of `orb360 run SEQUENCE --save-depth`: depth, confidence and source,
/// ordered by frame.
/// `min_error` as of DepthView. Throws UserError where an image cannot be read.
inline std::vector<RunView> ReadRunViews(const std::filesystem::path& sequence,
                                         const std::filesystem::path& run, double min_error) {
  const auto truth = ReadTrajectory(sequence / "groundtruth.txt");
  const auto poses = ReadTrajectory(run / "trajectory.txt");
  std::vector<RunView> views;
  for (size_t i = 0; i < truth.size(); ++i) {
    const auto index = static_cast<int>(i);
    const std::string name = NameOfFrame(index, "png");
    if (!std::filesystem::exists(run / "depth" / name)) continue;
    const auto pose = std::ranges::find_if(poses, [&](const StampedPose& p) {
      return std::abs(p.timestamp - truth[i].timestamp) < 1e-3;
    });
    if (pose == poses.end()) continue;
    DenseDepth depth{ReadDepthImage(run / "depth" / name),
                     ReadFractionImage(run / "confidence" / name),
                     {},
                     ReadSourceImage(run / "source" / name)};
    DepthView view(depth, pose->world_from_camera, min_error);
    views.push_back({index, std::move(depth), std::move(view)});
  }
  return views;
}

}  // namespace orb360
