#include "slam/pipeline/scale_state.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "slam/pipeline/assumed_height.h"
#include "slam/pipeline/ground.h"
#include "slam/pipeline/lens_distance.h"
#include "slam/pipeline/scale_drift.h"
#include "slam/scale/position_alignment.h"
#include "slam/scale/scale_smoother.h"

namespace orb360 {
namespace {

// All standard deviations are relative to the length.

// Of a step over the ground, beside that of the sweep: the camera bobs and the road is uneven.
constexpr double kReliefSigma = 0.01;
// Of the height over the plane of one keyframe's landmarks. Neighbouring keyframes see the same
// ones.
constexpr double kPlaneSigma = 0.05;
// Of a scale that only landmarks or only completed depth have shown: no image of the ground says
// that their plane is the ground. Completed depth has been wrong by a factor of four where the
// landmarks around it were far.
constexpr double kUnconfirmedSigma = 0.1;
constexpr double kCompletedSigma = 0.5;
// Of the distance between the lenses that stitching leaves near the ground, before anything has
// been measured, heights of the camera: cameras have 2 to 4 cm.
constexpr double kLensSigma = 0.01;

// Largest standard deviations of the states.
constexpr double kMaxMetric = 0.03;
constexpr double kMaxRough = 0.3;

// Standard deviation of the distance between the lenses, heights of the camera. Where it is not
// certain, the steps are measured without it.
double SigmaOf(const EstimatedLensDistance& lenses) {
  const auto& [value, sigma] = lenses.distance;
  if (!(sigma > 0)) return kLensSigma;
  if (lenses.is_certain) return sigma;
  const double information = 1 / (sigma * sigma);
  const double total = information + 1 / (kLensSigma * kLensSigma);
  return std::hypot(value * information / total, 1 / std::sqrt(total));
}

struct MapScale {
  double log_scale = 0;
  double sigma = 0;
  double spread = 0;  // part of sigma: SmoothedScale::spread
  bool has_positions = false;
  bool is_conflict = false;          // of the ground and the positions
  bool is_height_refuted = false;    // by positions, or because it varies where there are positions
  double length = 0;                 // of the path, in the map's unit
  int num_steps = 0;                 // keyframes whose images show the ground
  double sum_per_lens_distance = 0;  // of these: change of ln(step) with the distance of the lenses
  int num_planes = 0;                // keyframes whose landmarks show it
  std::vector<KeyframeScale> keyframes;
};

// The measurement of a keyframe by its own images of the ground, or else by its landmarks.
void Measure(const Map& map, const Keyframe& keyframe, const KnownGround& ground,
             const EstimatedLensDistance& lenses, ScaleNode* node, MapScale* scale) {
  for (const GroundStepFrom& step : keyframe.ground_steps) {
    if (!map.HasKeyframe(step.keyframe)) continue;
    const double distance = (keyframe.world_from_camera.translation -
                             map.keyframe(step.keyframe).world_from_camera.translation)
                                .norm();
    if (!(distance > 0)) continue;
    const double ratio = lenses.is_certain ? RatioWith(lenses.distance.value, step) : step.ratio;
    node->measured = std::log(ratio * ground.camera_height / distance);
    node->sigma = std::hypot(step.sigma, kReliefSigma);
    scale->sum_per_lens_distance += step.per_lens_distance / step.ratio;
    ++scale->num_steps;
    return;
  }
  if (const std::optional<GroundSighting> seen = GroundAt(map, keyframe.id, ground.up)) {
    node->measured = std::log(ground.camera_height / seen->height);
    node->sigma = kPlaneSigma;
    ++scale->num_planes;
  }
}

MapScale ScaleOf(const Map& map, int number, const std::optional<KnownGround>& ground,
                 double height_sigma, const EstimatedLensDistance& lenses) {
  MapScale result;
  const std::vector<KeyframeId> ids = map.KeyframeIds();
  std::vector<ScaleNode> nodes(ids.size());
  for (size_t i = 0; i < ids.size(); ++i) {
    const Keyframe& keyframe = map.keyframe(ids[i]);
    result.keyframes.push_back(
        {.frame = keyframe.frame_index, .timestamp = keyframe.timestamp, .map = number});
    nodes[i].drift_variance =
        i < 2 ? kLeastDrift : DriftVariance(map, ids[i - 2], ids[i - 1], ids[i]);
    if (i > 0) {
      nodes[i].path_length = (keyframe.world_from_camera.translation -
                              map.keyframe(ids[i - 1]).world_from_camera.translation)
                                 .norm();
    }
    result.length += nodes[i].path_length;
    if (ground && !ground->is_rough) Measure(map, keyframe, *ground, lenses, &nodes[i], &result);
  }
  const std::optional<SmoothedScale> smoothed = SmoothScale(nodes);
  if (!smoothed) {
    if (ground && ground->is_rough) result.sigma = std::hypot(kCompletedSigma, height_sigma);
    return result;
  }
  const double source_sigma =
      result.num_steps == 0 ? kUnconfirmedSigma
                            : SigmaOf(lenses) * result.sum_per_lens_distance / result.num_steps;
  // A scale that varies along the path means a height that varies, or a map that drifts: nothing
  // tells which, so that each part may be wrong by as much.
  result.spread = smoothed->spread;
  const double common = std::hypot(height_sigma, source_sigma, result.spread);
  result.log_scale = smoothed->mean;
  result.sigma = std::hypot(smoothed->mean_sigma, common);
  for (size_t i = 0; i < ids.size(); ++i) {
    result.keyframes[i].value = std::exp(smoothed->log_scale[i]);
    result.keyframes[i].sigma = std::hypot(smoothed->sigma[i], common);
  }
  return result;
}

/// The path of this run in a map: of its frames or, where none is given, of its keyframes.
std::vector<PathPoint> PathOf(const Map& map, int number, const FrameAnchors& frames) {
  std::vector<PathPoint> path;
  for (const auto& [index, anchor] : frames) {
    if (anchor.map != number) continue;
    const Rigid3 pose = map.PoseOf(anchor.reference) * anchor.reference_from_camera;
    path.push_back({anchor.timestamp, pose.translation});
  }
  for (const KeyframeId id : map.KeyframeIds()) {
    const Keyframe& keyframe = map.keyframe(id);
    if (!frames.empty() || !keyframe.IsOfThisRun()) continue;
    path.push_back({keyframe.timestamp, keyframe.world_from_camera.translation});
  }
  std::ranges::stable_sort(path, {}, &PathPoint::timestamp);
  return path;
}

/// The vertical of a map: the normal of its ground, or else that of its first camera.
UpDirection UpOf(const Map& map, const std::optional<KnownGround>& ground) {
  if (ground) return {ground->up.normalized(), kGroundUpSigma};
  const Rigid3& first = map.keyframe(map.KeyframeIds().front()).world_from_camera;
  return {first.rotation * Eigen::Vector3d::UnitZ(), kCameraUpSigma};
}

/// The scale of each map by the positions; none where they do not tell it.
std::vector<std::optional<ScaleMeasurement>> MeasureByPositions(
    std::span<const Map> maps, std::span<const std::optional<KnownGround>> grounds,
    const Positions& given, const FrameAnchors& frames) {
  std::vector<std::optional<ScaleMeasurement>> measured(maps.size());
  if (given.fixes.empty()) return measured;
  std::vector<size_t> longest_first(maps.size());
  std::iota(longest_first.begin(), longest_first.end(), 0);
  std::ranges::stable_sort(longest_first, std::ranges::greater(),
                           [&](size_t m) { return maps[m].num_keyframes(); });
  Positions positions = given;
  for (const size_t m : longest_first) {
    if (maps[m].num_keyframes() == 0) continue;
    const AlignmentResult result = AlignPositions(PathOf(maps[m], static_cast<int>(m), frames),
                                                  positions, UpOf(maps[m], grounds[m]));
    if (!result.alignment) continue;
    const PositionAlignment& alignment = *result.alignment;
    measured[m] =
        ScaleMeasurement{std::log(alignment.local_from_path.scale), alignment.log_scale_sigma};
    positions.clock_offset = alignment.clock_offset;
    positions.clock_offset_sigma = alignment.clock_offset_sigma;
  }
  return measured;
}

// Joins the scale of a map with that of positions along its keyframes. The ground and the positions
// have no error in common. An assumed height is a guess, which positions that contradict it refute:
// the camera flies, or stands on a mast. A height that varies is refuted by itself.
void UsePositions(const ScaleMeasurement& measured, bool is_height_assumed, MapScale* scale) {
  scale->has_positions = true;
  ScaleMeasurement fused = measured;
  if (scale->sigma > 0) {
    fused = FuseScales({scale->log_scale, scale->sigma}, measured, &scale->is_conflict);
    scale->is_height_refuted =
        (scale->is_conflict && is_height_assumed) || scale->spread > kMaxRough;
  }
  if (scale->is_height_refuted) {
    fused = measured;
    scale->is_conflict = false;
  }
  for (KeyframeScale& keyframe : scale->keyframes) {
    if (keyframe.sigma == 0) {
      keyframe.value = std::exp(fused.log_scale);
      keyframe.sigma = fused.sigma;
      continue;
    }
    // The scale along the path relative to its mean is known by the ground alone.
    const double apart =
        std::sqrt(std::max(0.0, keyframe.sigma * keyframe.sigma - scale->sigma * scale->sigma));
    keyframe.value *= std::exp(fused.log_scale - scale->log_scale);
    keyframe.sigma = std::hypot(fused.sigma, apart, scale->spread);
  }
  scale->log_scale = fused.log_scale;
  scale->sigma = fused.sigma;
}

std::vector<std::string> Sources(int num_steps, int num_planes) {
  std::vector<std::string> sources;
  if (num_steps > 0) sources.emplace_back("images of the ground");
  if (num_planes > 0) sources.emplace_back("landmarks on the ground");
  if (num_planes > num_steps && num_steps > 0) std::swap(sources[0], sources[1]);
  return sources;
}

}  // namespace

EstimatedScale EstimateScale(std::span<const Map> maps,
                             std::span<const std::optional<KnownGround>> grounds,
                             const ScaleOptions& options, const Positions& positions,
                             const FrameAnchors& frames) {
  EstimatedScale result;
  MetricScale& whole = result.whole;
  whole.is_height_assumed = options.camera_height == 0;
  whole.surroundings_rise = RiseOfSurroundings(maps, grounds);
  const double height_sigma = whole.is_height_assumed ? AssumedHeightSigma(whole.surroundings_rise)
                                                      : options.camera_height_sigma;
  const EstimatedLensDistance lenses = EstimateLensDistance(maps);
  const std::vector<std::optional<ScaleMeasurement>> measured =
      MeasureByPositions(maps, grounds, positions, frames);
  int num_steps = 0;
  int num_planes = 0;
  double length = 0;
  double sum_of_logs = 0;
  bool is_known = !maps.empty();
  bool is_completed = false;
  bool has_positions = !maps.empty();
  bool is_conflict = false;
  bool is_height_used = true;
  for (size_t m = 0; m < maps.size(); ++m) {
    MapScale scale = ScaleOf(maps[m], static_cast<int>(m), grounds[m], height_sigma, lenses);
    if (measured[m]) UsePositions(*measured[m], whole.is_height_assumed, &scale);
    has_positions = has_positions && scale.has_positions;
    is_height_used = is_height_used && !scale.is_height_refuted;
    is_conflict = is_conflict || scale.is_conflict;
    result.keyframes.insert(result.keyframes.end(), scale.keyframes.begin(), scale.keyframes.end());
    num_steps += scale.num_steps;
    num_planes += scale.num_planes;
    result.maps.push_back({scale.log_scale, scale.sigma});
    length += scale.length;
    sum_of_logs += scale.length * scale.log_scale;
    whole.sigma = std::max(whole.sigma, scale.sigma);
    is_known = is_known && scale.sigma > 0;
    is_completed = is_completed || (grounds[m] && grounds[m]->is_rough);
  }
  if (is_height_used) {
    whole.sources = Sources(num_steps, num_planes);
    if (is_completed) whole.sources.emplace_back("completed depth");
    if (!whole.sources.empty()) whole.camera_height = options.height();
  }
  if (has_positions) whole.sources.emplace_back("positions");
  if (lenses.is_certain && is_height_used)
    whole.lens_distance = lenses.distance.value * options.height();
  if (!is_known) {
    whole.sigma = 0;
    return result;
  }
  whole.value = length > 0 ? std::exp(sum_of_logs / length) : 1.0;
  const bool is_given = has_positions || !whole.is_height_assumed;
  if (whole.sigma <= kMaxMetric && is_given && !is_conflict) {
    whole.state = ScaleState::kMetric;
  } else if (whole.sigma <= kMaxRough) {
    whole.state = ScaleState::kRough;
  }
  return result;
}

const char* ToString(ScaleState state) {
  switch (state) {
    case ScaleState::kMetric:
      return "metric";
    case ScaleState::kRough:
      return "rough";
    case ScaleState::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace orb360
