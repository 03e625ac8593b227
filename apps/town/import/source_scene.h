#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace orb360::town {

/// The description of a surface in a file of meshes.
struct SourceMaterial {
  Eigen::Vector3f colour = Eigen::Vector3f::Ones();  ///< linear factor on the texture
  std::string texture;     ///< file, relative to the mesh's folder; empty for none
  cv::Mat image = {};      ///< the texture itself, where it is inside the file
  bool is_opaque = false;  ///< whatever the texture's coverage says
  bool is_liquid = false;  ///< nobody stands on it
};

/// Triangles of one material, in the axes and the unit of the file.
struct SourceMesh {
  std::string name;
  size_t material = 0;
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< unit, one for each position, or none
  /// One entry per position, or none; v points upward, in tiles.
  std::vector<Eigen::Vector2f> texture_coordinates;
  std::vector<Eigen::Vector3f> colours;  ///< linear factors, one for each position, or none
  /// Baked light on the front, one for each position, or none: linear red, green and blue that
  /// multiply the texture, 1 where the surface looks as its texture does.
  std::vector<Eigen::Vector3f> irradiance;
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// The contents of a file of meshes.
struct SourceScene {
  std::vector<SourceMaterial> materials;
  std::vector<SourceMesh> meshes;
  /// Other files with decorations that could not be found, each once, with the reason.
  std::vector<std::string> missing = {};
  std::vector<Eigen::Vector3f> starts = {};  ///< places where people begin, if the file says
};

}  // namespace orb360::town
