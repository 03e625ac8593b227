#include "slam/evaluation/local_scale.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Times the median number of true poses from one pair to the next; more is a gap.
constexpr double kGap = 1.5;
constexpr double kLeastMotion = 1e-6;  // of an estimate, as a fraction of the true length
constexpr double kRounding = 1e-6;     // metres, by which a window may reach beyond a piece

/// A pose of the true path that both lengths may be measured to.
struct Node {
  Eigen::Vector3d truth;
  const PosePair* pair = nullptr;  // null for a true pose inside a gap
  bool is_first = false;           // of its piece
  bool is_last = false;
};

/// A point of a piece: lengths of both paths up to it.
struct Vertex {
  double travelled;  // true path from the first true pose, metres
  double estimated;  // estimated path from the start of the piece, in units of the estimate
  double timestamp;  // seconds
};

/// A part of the estimate without gaps.
using Piece = std::vector<Vertex>;

struct OrderedTruth {
  std::vector<StampedPose> poses;  // in the order of time
  std::vector<size_t> of_pair;     // index of each pair's true pose among them
};

OrderedTruth OrderTruth(std::span<const StampedPose> truth, std::span<const PosePair> pairs) {
  OrderedTruth ordered{{truth.begin(), truth.end()}, {}};
  std::ranges::stable_sort(ordered.poses, {}, &StampedPose::timestamp);
  size_t next = 0;  // Poses with equal times belong to different pairs.
  for (const PosePair& pair : pairs) {
    const auto at =
        std::ranges::lower_bound(ordered.poses.begin() + static_cast<ptrdiff_t>(next),
                                 ordered.poses.end(), pair.timestamp, {}, &StampedPose::timestamp);
    ORB360_CHECK(at != ordered.poses.end() && at->timestamp == pair.timestamp, pair.timestamp);
    ordered.of_pair.push_back(static_cast<size_t>(at - ordered.poses.begin()));
    next = ordered.of_pair.back() + 1;
  }
  return ordered;
}

/// Returns for each pair whether there is a gap before it. There is one before the first.
std::vector<bool> FindGaps(const OrderedTruth& truth, std::span<const PosePair> pairs,
                           std::span<const double> map_changes) {
  std::vector<double> steps;
  for (size_t i = 1; i < pairs.size(); ++i) {
    steps.push_back(static_cast<double>(truth.of_pair[i] - truth.of_pair[i - 1]));
  }
  const double usual = Median(std::vector<double>(steps));
  std::vector<bool> has_gap(pairs.size(), true);
  for (size_t i = 1; i < pairs.size(); ++i) {
    const bool changes_map = std::ranges::any_of(map_changes, [&](double time) {
      return pairs[i - 1].timestamp < time && time <= pairs[i].timestamp;
    });
    has_gap[i] = steps[i - 1] > kGap * usual || changes_map;
  }
  return has_gap;
}

std::vector<Node> MakeNodes(const OrderedTruth& truth, std::span<const PosePair> pairs,
                            const std::vector<bool>& has_gap) {
  std::vector<Node> nodes;
  size_t next = 0;  // true pose
  for (size_t i = 0; i < pairs.size(); ++i) {
    for (; has_gap[i] && next < truth.of_pair[i]; ++next) {
      nodes.push_back({truth.poses[next].world_from_camera.translation});
    }
    nodes.push_back({pairs[i].truth_from_camera.translation, &pairs[i], has_gap[i],
                     i + 1 == pairs.size() || has_gap[i + 1]});
    next = truth.of_pair[i] + 1;
  }
  return nodes;
}

/// Measures both paths by the same chords. Each piece begins and ends with a pair.
std::vector<Piece> MakePieces(const std::vector<Node>& nodes) {
  std::vector<Piece> pieces;
  const Node* last = &nodes.front();  // node at which the last chord ended
  double travelled = 0.0;
  for (const Node& node : nodes) {
    const double chord = (node.truth - last->truth).norm();
    if (chord < LocalScale::kSpacing && !node.is_first && !node.is_last) continue;
    travelled += chord;
    if (node.is_first) {
      pieces.push_back({{travelled, 0.0, node.pair->timestamp}});
    } else if (node.pair != nullptr) {
      const double estimated = (node.pair->estimate_from_camera.translation -
                                last->pair->estimate_from_camera.translation)
                                   .norm();
      pieces.back().push_back(
          {travelled, pieces.back().back().estimated + estimated, node.pair->timestamp});
    }
    last = &node;
  }
  return pieces;
}

/// Returns the place at a length of the true path, interpolated in a piece of two vertices or more.
Vertex VertexAt(const Piece& piece, double travelled) {
  const auto end =
      std::upper_bound(piece.begin() + 1, piece.end() - 1, travelled,
                       [](double value, const Vertex& vertex) { return value < vertex.travelled; });
  const Vertex& a = *(end - 1);
  const double chord = end->travelled - a.travelled;
  const double fraction =
      std::clamp(chord > 0.0 ? (travelled - a.travelled) / chord : 0.0, 0.0, 1.0);
  return {travelled, a.estimated + fraction * (end->estimated - a.estimated),
          a.timestamp + fraction * (end->timestamp - a.timestamp)};
}

using Windows = std::map<int64_t, LocalScale::Window>;

/// Returns the windows of `length` metres that do not reach beyond a piece, by the number of steps
/// to their start.
Windows MeasureWindows(const std::vector<Piece>& pieces, double length) {
  Windows windows;
  for (const Piece& piece : pieces) {
    if (piece.size() < 2) continue;
    const double first = (piece.front().travelled - kRounding) / LocalScale::kStep;
    for (int64_t i = static_cast<int64_t>(std::ceil(first));; ++i) {
      const double begin = LocalScale::kStep * static_cast<double>(i);
      if (begin + length > piece.back().travelled + kRounding) break;
      const Vertex from = VertexAt(piece, begin);
      const Vertex to = VertexAt(piece, begin + length);
      const double estimated = to.estimated - from.estimated;
      windows[i] = {.begin = begin,
                    .ratio = length / std::max(estimated, kLeastMotion * length),
                    .begin_time = from.timestamp,
                    .end_time = to.timestamp};
    }
  }
  return windows;
}

/// Returns |difference of ln(ratio)| of all windows that are kDriftLength apart.
std::vector<double> Drifts(const Windows& windows) {
  const int64_t apart = std::llround(LocalScale::kDriftLength / LocalScale::kStep);
  std::vector<double> drifts;
  for (const auto& [step, window] : windows) {
    const auto other = windows.find(step + apart);
    if (other == windows.end()) continue;
    drifts.push_back(std::abs(std::log(other->second.ratio / window.ratio)));
  }
  return drifts;
}

}  // namespace

std::optional<LocalScale> MeasureLocalScale(std::span<const StampedPose> truth,
                                            std::span<const PosePair> pairs,
                                            std::span<const double> map_changes) {
  if (pairs.size() < 2) return std::nullopt;
  const OrderedTruth ordered = OrderTruth(truth, pairs);
  const std::vector<Piece> pieces =
      MakePieces(MakeNodes(ordered, pairs, FindGaps(ordered, pairs, map_changes)));
  const Windows windows = MeasureWindows(pieces, LocalScale::kWindow);
  if (windows.empty()) return std::nullopt;

  LocalScale scale;
  for (const auto& [step, window] : windows) scale.windows.push_back(window);
  const auto [min, max] = std::ranges::minmax(scale.windows, {}, &LocalScale::Window::ratio);
  scale.min = min.ratio;
  scale.max = max.ratio;
  std::vector<double> drifts = Drifts(windows);
  if (!drifts.empty()) {
    scale.drift_median = Median(drifts);
    scale.drift_worst = std::ranges::max(drifts);
  }
  for (const auto& [step, window] : MeasureWindows(pieces, LocalScale::kDriftLength)) {
    scale.worst_deviation =
        std::max(scale.worst_deviation.value_or(0.0), std::abs(window.ratio - 1.0));
  }
  return scale;
}

}  // namespace orb360
