#include "apps/town/import/torcs_track.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "nn/base/number_text.h"

namespace orb360::town {
namespace {

using Line = std::vector<Eigen::Vector3f>;

/// Largest distance between the ends of pieces that join, and between points of the result, metres.
/// Some circuits have a piece of a metre at the starting line.
constexpr float kJoint = 2;

struct Piece {
  int number;
  Line middle;
};

std::optional<int> PieceNumber(std::string_view name) {
  constexpr std::string_view kPrefix = "TKMN";
  if (!name.starts_with(kPrefix)) return std::nullopt;
  return ParseNumber<int>(name.substr(kPrefix.size()));
}

/// Returns the middles of the pairs of vertices.
Line Middles(const SourceMesh& mesh) {
  Line middles;
  for (size_t i = 0; i + 1 < mesh.positions.size(); i += 2)
    middles.emplace_back(0.5F * (mesh.positions[i] + mesh.positions[i + 1]));
  return middles;
}

/// Removes the piece that begins or ends nearest to `end`, reversed if necessary to begin there.
/// Returns nullopt if none is within kJoint.
std::optional<Piece> TakeNext(const Eigen::Vector3f& end, std::vector<Piece>* pieces) {
  float nearest = kJoint;
  auto best = pieces->end();
  bool is_backward = false;
  for (auto piece = pieces->begin(); piece != pieces->end(); ++piece) {
    const float to_front = (piece->middle.front() - end).norm();
    const float to_back = (piece->middle.back() - end).norm();
    if (std::min(to_front, to_back) >= nearest) continue;
    nearest = std::min(to_front, to_back);
    best = piece;
    is_backward = to_back < to_front;
  }
  if (best == pieces->end()) return std::nullopt;
  Piece next = std::move(*best);
  pieces->erase(best);
  if (is_backward) std::reverse(next.middle.begin(), next.middle.end());
  return next;
}

}  // namespace

std::vector<Eigen::Vector3f> FindTorcsCentreline(const SourceScene& scene) {
  std::vector<Piece> pieces;
  for (const SourceMesh& mesh : scene.meshes) {
    const std::optional<int> number = PieceNumber(mesh.name);
    const size_t count = mesh.positions.size();
    if (number && count >= 4 && count % 2 == 0) pieces.push_back({*number, Middles(mesh)});
  }
  if (pieces.empty()) return {};
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.number < b.number; });

  std::vector<int> numbers = {pieces.front().number};
  Line ring = std::move(pieces.front().middle);
  pieces.erase(pieces.begin());
  while (const std::optional<Piece> next = TakeNext(ring.back(), &pieces)) {
    ring.insert(ring.end(), next->middle.begin(), next->middle.end());
    numbers.push_back(next->number);
  }
  if ((ring.back() - ring.front()).norm() > kJoint) return {};
  int ascents = 0;  // less descents, all round the ring
  for (size_t i = 0; i < numbers.size(); ++i)
    ascents += numbers[(i + 1) % numbers.size()] > numbers[i] ? 1 : -1;
  if (ascents < 0) std::reverse(ring.begin(), ring.end());
  Line line;  // neighbouring pieces share their ends
  for (const Eigen::Vector3f& p : ring) {
    const bool is_new =
        line.empty() || ((p - line.back()).norm() > kJoint && (p - line.front()).norm() > kJoint);
    if (is_new) line.push_back(p);
  }
  return line;
}

}  // namespace orb360::town
