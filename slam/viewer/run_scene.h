#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "slam/io/scale_file.h"
#include "slam/io/sparse_model.h"
#include "slam/viewer/comparison.h"

namespace orb360 {

/// What the viewer's page shows of a run besides the points of its cloud.
struct RunScene {
  std::string folder;      ///< As the user named it.
  nlohmann::json summary;  ///< Content of summary.json.
  SparseModel model;       ///< Without observations, no links between keyframes are shown.
  std::vector<StampedScale> scales;  ///< Content of scale.txt.
  /// Indices of the keyframes whose images the input still has.
  std::vector<int> images;
  std::vector<int> views;                ///< Indices of the frames whose image and range there are.
  bool has_cloud = false;                ///< Whether there is an octree.
  std::optional<double> voxel_size;      ///< Of a dense cloud, units; summary.json may be older.
  std::optional<Comparison> comparison;  ///< With another path.
  bool has_other_cloud = false;          ///< Whether there is an octree of the other run.
  std::vector<std::string> missing;  ///< One sentence for each thing that cannot be shown, and why.
};

/// Whether the lengths of a run are metres, by its summary.json.
bool HasMetres(const nlohmann::json& summary);

/// Two keyframes that observe the same landmarks.
struct KeyframeLink {
  int first = 0;   ///< Index among the keyframes.
  int second = 0;  ///< The same, larger.
  int shared = 0;  ///< Number of landmarks.
};

/// The links of the keyframe graph, ordered: for each keyframe those to the 8 with which it shares
/// most landmarks, at least 15.
std::vector<KeyframeLink> LinkKeyframes(const SparseModel& model);

/// Returns the page's `run.json`. Poses are those of the optical camera frame in the world of
/// written files, rounded to 1e-5 units.
///
/// | key | meaning |
/// |---|---|
/// | `folder`, `summary`, `images`, `views`, `missing` | as in RunScene |
/// | `hasCloud` | as in RunScene |
/// | `unit` | `m`, or `units` where the scale is unknown |
/// | `voxelSize` | as in RunScene, or null |
/// | `frames` | `index`, `time` (s), `map`, `position` (3 numbers each), `orientation` (x y z w) |
/// | `keyframes` | places of the keyframes among the frames |
/// | `links` | 3 numbers each: places of two among the keyframes, number of landmarks in common |
/// | `loops` | pairs of places among the frames: the one that came back, and where |
/// | `comparison` | ComparisonJson with `hasCloud` (has_other_cloud), or null |
/// | `scale` | `time`, `value`, `sigma` along the path |
std::string SceneJson(const RunScene& scene);

}  // namespace orb360
