#include "apps/town/import/torcs_track.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>

namespace orb360::town {
namespace {

constexpr std::string_view kPrefix = "TKMN";

/// Middles of the pairs of vertices.
std::vector<Eigen::Vector3f> Middles(const SourceMesh& mesh) {
  std::vector<Eigen::Vector3f> middles;
  for (size_t i = 0; i + 1 < mesh.positions.size(); i += 2)
    middles.emplace_back(0.5F * (mesh.positions[i] + mesh.positions[i + 1]));
  return middles;
}

}  // namespace

std::vector<Eigen::Vector3f> FindTorcsCentreline(const SourceScene& scene) {
  std::map<int, std::vector<Eigen::Vector3f>> pieces;  // by their number
  for (const SourceMesh& mesh : scene.meshes) {
    if (!mesh.name.starts_with(kPrefix)) continue;
    int number = 0;
    const char* end = mesh.name.data() + mesh.name.size();
    const auto [rest, error] = std::from_chars(mesh.name.data() + kPrefix.size(), end, number);
    if (error == std::errc() && rest == end) pieces.emplace(number, Middles(mesh));
  }
  std::vector<Eigen::Vector3f> line;
  for (auto& [number, piece] : pieces) {
    if (piece.empty()) continue;
    if (!line.empty() && (piece.back() - line.back()).norm() < (piece.front() - line.back()).norm())
      std::reverse(piece.begin(), piece.end());
    // Neighbouring pieces share their ends.
    for (const Eigen::Vector3f& p : piece) {
      if (line.empty() || (p - line.back()).norm() > 0.5F) line.push_back(p);
    }
  }
  return line;
}

}  // namespace orb360::town
