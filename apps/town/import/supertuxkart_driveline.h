#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

/// A line across a road, in metres, in the axes of ReadSuperTuxKartScene.
struct RoadSection {
  Eigen::Vector3f left;
  Eigen::Vector3f right;
};

/// Reads the main loop of a track of SuperTuxKart, once round in driving direction, from quads.xml
/// and graph.xml in the folder of its scene.xml. Each section is the beginning of a quad. Throws
/// UserError for damaged files and for arenas, which have no driveline.
std::vector<RoadSection> ReadSuperTuxKartDriveline(const std::filesystem::path& scene_file);

}  // namespace orb360::town
