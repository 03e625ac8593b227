#include "slam/pipeline/patch_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "slam/pipeline/landmark_fusion.h"
#include "slam/pipeline/patch_view.h"
#include "slam/pipeline/projection_search.h"

namespace orb360 {
namespace {

// Surfaces seen from more than 45 degrees (cosine) beside their usual direction look different.
constexpr double kMinViewCosine = 0.7;
// A patch found this near a corner, in standard deviations of the corner, is there because of it:
// 95 % are nearer.
constexpr double kCornerSigmas = 2.45;

struct Sighting {
  Eigen::Vector3d bearing;  // unit, camera frame
  PatchSlope slope;
  int level;     // of the pyramid, where a corner of the landmark would be found
  double sigma;  // of that corner, rad
};

std::optional<Sighting> LookFor(const Landmark& landmark, const Keyframe& keyframe,
                                const Map& map) {
  const Rigid3 camera_from_world = keyframe.world_from_camera.Inverse();
  const std::optional<int> level = ExpectLevel(camera_from_world * landmark.position,
                                               camera_from_world.rotation * landmark.mean_direction,
                                               landmark.max_range, kMinViewCosine);
  if (!level) return std::nullopt;
  const std::optional<PatchView> guess = ViewPatch(map, landmark, keyframe);
  if (!guess) return std::nullopt;
  const std::optional<AlignedPatch> aligned = AlignPatch(
      landmark.patch->patch, *guess->level, guess->grid, guess->stretch, landmark.patch_slope);
  if (!aligned) return std::nullopt;
  const Observation& newest = landmark.observations.back();
  const Keypoint& seen = map.keyframe(newest.keyframe).features->keypoints[newest.feature];
  return Sighting{guess->level->camera.Bearing(aligned->center), aligned->slope, *level,
                  seen.sigma * RangeAtLevelZero(1.0, *level - seen.level)};
}

// What is at a place already.
struct Occupant {
  bool has_landmark = false;
  int free_corner = -1;  // the nearest without a landmark, on the sighting's level or next to it
};

Occupant WhoIsAt(const Sighting& sighting, const Features& features,
                 const std::vector<uint8_t>& is_mapped, std::vector<int>* nearby) {
  const double radius = kCornerSigmas * sighting.sigma;
  const double min_cosine = std::cos(radius);
  nearby->clear();
  features.grid.Query(sighting.bearing, radius, nearby);
  Occupant occupant;
  double nearest = min_cosine;
  for (const int f : *nearby) {
    const double cosine = features.bearings[f].dot(sighting.bearing);
    if (cosine < min_cosine) continue;
    if (is_mapped[features.corners[f]]) occupant.has_landmark = true;
    if (std::abs(features.keypoints[f].level - sighting.level) > 1 || cosine < nearest) continue;
    nearest = cosine;
    occupant.free_corner = f;
  }
  return occupant;
}

// Gives the feature's number.
int AppendFeature(const Sighting& sighting, const Landmark& landmark,
                  const EquirectangularCamera& camera, Features* features) {
  const int feature = features->size();
  features->keypoints.push_back({camera.Project(sighting.bearing).cast<float>(), 0.0f,
                                 static_cast<float>(sighting.sigma),
                                 static_cast<uint8_t>(sighting.level), 0});
  features->bearings.push_back(sighting.bearing);
  features->descriptors.push_back(landmark.descriptor);
  if (!features->colors.empty()) features->colors.push_back(landmark.color);
  features->corners.push_back(feature);
  return feature;
}

}  // namespace

void FindByPatches(KeyframeId id, int max_neighbours, Map* map) {
  Keyframe& keyframe = map->keyframe(id);
  if (!keyframe.image) return;
  std::vector<KeyframeId> others;
  for (const Map::Covisible& neighbour : map->FindCovisible(keyframe.landmarks, 1, id)) {
    if (static_cast<int>(others.size()) == max_neighbours) break;
    others.push_back(neighbour.keyframe);
  }
  // Those who have the features do not see them change.
  auto features = std::make_shared<Features>(*keyframe.features);
  std::vector<uint8_t> is_mapped = FindMappedCorners(keyframe);
  struct Found {
    LandmarkId landmark;
    int feature;
    Sighting sighting;
  };
  std::vector<Found> found;
  std::vector<int> nearby;
  for (const LandmarkId landmark_id : LandmarksSeenBy(others, *map)) {
    const Landmark& landmark = map->landmark(landmark_id);
    if (!landmark.patch || landmark.FindObservation(id) != nullptr) continue;
    const std::optional<Sighting> sighting = LookFor(landmark, keyframe, *map);
    if (!sighting) continue;
    const Occupant occupant = WhoIsAt(*sighting, *features, is_mapped, &nearby);
    const double min_cosine = std::cos(kCornerSigmas * sighting->sigma);
    const bool is_taken = std::ranges::any_of(found, [&](const Found& other) {
      return other.sighting.bearing.dot(sighting->bearing) > min_cosine;
    });
    if (occupant.has_landmark || is_taken) continue;
    int feature = occupant.free_corner;
    if (feature < 0) {
      feature = AppendFeature(*sighting, landmark, keyframe.image->front().camera, &*features);
    } else {
      is_mapped[features->corners[feature]] = 1;
    }
    found.push_back({landmark_id, feature, *sighting});
  }
  keyframe.landmarks.resize(features->size(), kNoId);
  keyframe.features = std::move(features);
  for (const Found& f : found) {
    map->AddObservation(f.landmark, id, f.feature);
    Landmark& landmark = map->landmark(f.landmark);
    landmark.patch_slope = f.sighting.slope;
    Observation& observation = *landmark.FindObservation(id);
    observation.aligned_bearing = f.sighting.bearing.cast<float>();
    observation.aligned_sigma = static_cast<float>(kAlignedNoise * f.sighting.sigma);
    observation.was_compared = true;
    map->UpdateAppearance(f.landmark);
  }
}

}  // namespace orb360
