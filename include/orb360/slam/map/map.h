#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/features/features.h>
#include <orb360/slam/features/patch.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

// Images are stored here but not looked at, so that code that uses maps does not depend on OpenCV.
struct PyramidLevel;
using SpherePyramid = std::vector<PyramidLevel>;  // sphere_pyramid.h

/// Keyframes and landmarks refer to each other by id. An id is the index in the map and is never
/// reused after removal.
using KeyframeId = int;
using LandmarkId = int;
inline constexpr int kNoId = -1;

/// An observation of one landmark by feature `feature` of keyframe `keyframe`.
struct Observation {
  KeyframeId keyframe = kNoId;
  int feature = 0;
  /// Direction in which the keyframe's image shows the landmark's patch, which is more exact than
  /// the feature's: unit vector, camera frame. aligned_sigma is its angular noise, rad; 0 if the
  /// direction is not known.
  Eigen::Vector3f aligned_bearing = Eigen::Vector3f::Zero();
  float aligned_sigma = 0;
  bool was_compared = false;  // with the landmark's patch, whatever came of it
};

/// A patch of a keyframe's image around a landmark, with which later images are aligned.
struct LandmarkPatch {
  KeyframeId keyframe;      // may have been removed since
  Eigen::Vector3d bearing;  // of the patch's centre, unit, in its camera frame
  double spacing;           // of its samples on the tangent plane (TangentBasis), rad
  Patch patch;
};

/// Range of a feature from completed depth, independent of any landmark.
struct RangePrior {
  float range = 0;  // along the bearing, world units
  float sigma = 0;  // standard deviation of ln(range); 0 where nothing is known
};

struct Keyframe {
  KeyframeId id = kNoId;
  int frame_index = 0;
  double timestamp = 0;  // s
  Rigid3 world_from_camera;
  std::shared_ptr<const Features> features;
  std::vector<LandmarkId> landmarks;           // by feature; kNoId where it sees none
  std::vector<RangePrior> range_priors;        // by feature; empty where its depth is not completed
  std::shared_ptr<const SpherePyramid> image;  // kept for a while only

  RangePrior PriorOf(int feature) const {
    return range_priors.empty() ? RangePrior{} : range_priors[feature];
  }
};

/// For each corner (`Features::corners`): whether it has a landmark, by a feature of any level.
std::vector<uint8_t> FindMappedCorners(const Keyframe& keyframe);

struct Landmark {
  LandmarkId id = kNoId;
  Eigen::Vector3d position;        // world
  Eigen::Vector3d mean_direction;  // unit, from the cameras that see it towards it, world
  double max_range = 0;            // where it would be seen on pyramid level 0
  Descriptor descriptor{};         // the most typical of its observations'
  Color color{};
  KeyframeId first_keyframe = kNoId;           // the newest keyframe when it was made
  std::vector<Observation> observations;       // ordered by keyframe
  std::shared_ptr<const LandmarkPatch> patch;  // null where no image that shows it was kept
  PatchSlope patch_slope;                      // of the surface in it
  int visible = 1;                             // frames in which it should have been seen
  int found = 1;                               // and was

  /// Returns null if the keyframe does not observe the landmark.
  const Observation* FindObservation(KeyframeId from) const;
  Observation* FindObservation(KeyframeId from);
};

/// Returns the range at which a feature of pyramid level l at `range` would appear on level 0.
/// Scales grow by 2^(1/4) per level (sphere_pyramid.h).
double RangeAtLevelZero(double range, int level);
/// The inverse: returns the level, rounded and not clamped, on which a landmark appears at `range`.
int PredictLevel(double max_range, double range);

/// The map: keyframes, landmarks and the observations between them. A map is a value with one owner
/// and without locks. Copies share features, images and patches; everything else is copied.
///
/// Invariant: landmark l lists the observation (k, f) exactly when keyframe k lists l at feature f.
class Map {
 public:
  KeyframeId AddKeyframe(int frame_index, double timestamp, const Rigid3& world_from_camera,
                         std::shared_ptr<const Features> features);
  /// Removes a keyframe and its observations. Its pose is kept relative to another keyframe,
  /// `successor`: from now on PoseOf(id) follows the successor.
  void RemoveKeyframe(KeyframeId id, KeyframeId successor);

  /// Releases the images of all keyframes except the newest `num_kept`.
  void ForgetImages(int num_kept);

  /// Adds a landmark without observations.
  LandmarkId AddLandmark(const Eigen::Vector3d& position, const Color& color);
  void RemoveLandmark(LandmarkId id);
  /// Moves the observations of `from` to `to` and removes `from`. Where a keyframe observes both,
  /// `to` keeps its own observation. Resolve(from) is `to` from now on. Moved observations are not
  /// yet aligned with the patch of `to`.
  void MergeLandmark(LandmarkId from, LandmarkId to);

  /// Contract: neither the landmark nor the feature has an observation of the other yet.
  void AddObservation(LandmarkId landmark, KeyframeId keyframe, int feature);
  void RemoveObservation(LandmarkId landmark, KeyframeId keyframe);

  /// Recomputes descriptor, mean direction and range limit from the observations, of which there
  /// must be at least one.
  void UpdateAppearance(LandmarkId id);

  bool HasKeyframe(KeyframeId id) const {
    return id >= 0 && id < keyframe_end() && keyframes_[id].has_value();
  }
  bool HasLandmark(LandmarkId id) const {
    return id >= 0 && id < landmark_end() && landmarks_[id].has_value();
  }
  /// Contract: the keyframe or landmark exists.
  Keyframe& keyframe(KeyframeId id);
  const Keyframe& keyframe(KeyframeId id) const;
  Landmark& landmark(LandmarkId id);
  const Landmark& landmark(LandmarkId id) const;

  /// Returns the landmark that contains `id` now, or kNoId if it was removed.
  LandmarkId Resolve(LandmarkId id) const;
  /// Returns world_from_camera of a keyframe, which may have been removed.
  Rigid3 PoseOf(KeyframeId id) const;
  /// Returns an existing keyframe that represents `id`: itself or its successor.
  KeyframeId LivingKeyframe(KeyframeId id) const;

  /// One more than the largest id ever given, for loops over all ids with Has...().
  KeyframeId keyframe_end() const { return static_cast<int>(keyframes_.size()); }
  LandmarkId landmark_end() const { return static_cast<int>(landmarks_.size()); }
  int num_keyframes() const { return num_keyframes_; }
  int num_landmarks() const { return num_landmarks_; }
  std::vector<KeyframeId> KeyframeIds() const;

  struct Covisible {
    KeyframeId keyframe;
    int shared;  // landmarks seen by both
  };
  /// Returns keyframes that observe at least `min_shared` of the landmarks, ordered by that number
  /// (largest first; ties: newest first), without `except`.
  std::vector<Covisible> FindCovisible(std::span<const LandmarkId> landmarks, int min_shared,
                                       KeyframeId except = kNoId) const;

  /// Returns the median distance of a keyframe's landmarks from it, or 0 if it has none.
  double MedianRange(KeyframeId id) const;

  /// Applies target_from_world to every pose, landmark and range, which is a change of gauge.
  void Transform(const Similarity3& target_from_world);
  /// Deforms the map. `corrections` contains, for each keyframe id, the similarity that moves the
  /// world around that keyframe; entries of removed keyframes are those of the keyframes that
  /// represent them. A landmark moves with the middle one of the keyframes that observe it.
  void Deform(std::span<const Similarity3> corrections);

  /// Adds all keyframes and landmarks of another map in the same world. Their ids grow by the
  /// keyframe_end() and landmark_end() that this map had before.
  void Append(const Map& other);

  /// Throws ContractError if the invariant is violated; for tests.
  void CheckConsistency() const;

 private:
  struct Successor {
    KeyframeId keyframe = kNoId;
    Rigid3 successor_from_camera;
  };
  std::vector<std::optional<Keyframe>> keyframes_;
  std::vector<Successor> successors_;  // by keyframe id; set for removed ones
  std::vector<std::optional<Landmark>> landmarks_;
  std::vector<LandmarkId> merged_into_;  // by landmark id; kNoId unless merged
  int num_keyframes_ = 0;
  int num_landmarks_ = 0;
};

}  // namespace orb360
