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

struct PyramidLevel;
/// Image pyramid of a keyframe, with a margin that continues the sphere. A map stores it but does
/// not look at it, so that code that uses maps does not depend on OpenCV.
using SpherePyramid = std::vector<PyramidLevel>;

/// Index of a keyframe in its map, from 0. It is never reused after removal.
using KeyframeId = int;
/// Index of a landmark in its map, from 0. It is never reused after removal.
using LandmarkId = int;
/// The id of no keyframe and no landmark.
inline constexpr int kNoId = -1;

/// An observation of one landmark by a feature of a keyframe.
struct Observation {
  KeyframeId keyframe = kNoId;  ///< The keyframe that observes the landmark.
  int feature = 0;              ///< Index of the feature in Keyframe::features.
  /// Direction in which the keyframe's image shows the landmark's patch, found by alignment of gray
  /// values: unit vector, camera frame. It is more exact than the feature's bearing.
  Eigen::Vector3f aligned_bearing = Eigen::Vector3f::Zero();
  /// Angular noise of aligned_bearing, radians; 0 where that is not known.
  float aligned_sigma = 0;
  /// Whether the image was compared with the landmark's patch, with or without success.
  bool was_compared = false;
};

/// A patch of a keyframe's image around a landmark, with which later images are aligned.
struct LandmarkPatch {
  /// The keyframe whose image contains the patch. It may have been removed since (Map::PoseOf).
  KeyframeId keyframe;
  Eigen::Vector3d bearing;  ///< Direction of the centre, unit vector, camera frame.
  double spacing;           ///< Angle between samples on the tangent plane, radians.
  Patch patch;              ///< Gray values of the samples.
};

/// Range of a feature from completed depth, independent of any landmark.
struct RangePrior {
  float range = 0;  ///< Range along the bearing, world units.
  float sigma = 0;  ///< Standard deviation of ln(range); 0 where nothing is known.
};

/// A measurement of the distance between the lens that looks ahead and the one that looks back, as
/// far as stitching has left it, heights of the camera. Sigma is 0 where nothing is known.
struct LensDistance {
  double value = 0;  ///< Heights of the camera.
  double sigma = 0;  ///< Standard deviation of it; 0: unknown.
};

/// The motion from another keyframe, measured on the ground. Frame 1 is that of the other keyframe,
/// frame 2 that of the keyframe that has this step.
struct GroundStepFrom {
  KeyframeId keyframe = kNoId;  ///< The other keyframe. It may have been removed since.
  double ratio = 0;             ///< Length, divided by the camera's height over the ground.
  double sigma = 0;             ///< Standard deviation of ln(ratio).
  /// The point of the ground below the point half-way, heights of the camera, frame 1.
  Eigen::Vector3d point1 = Eigen::Vector3d::Zero();
  /// The same point in frame 2.
  Eigen::Vector3d point2 = Eigen::Vector3d::Zero();
  /// Direction of the motion, unit, frame 1.
  Eigen::Vector3d direction1 = Eigen::Vector3d::Zero();
  /// The same direction in frame 2.
  Eigen::Vector3d direction2 = Eigen::Vector3d::Zero();
  /// Standard deviation of the rotation about the ground's normal between the frames, rad.
  double turn_sigma = 0;
  /// Normal of the ground below the point half-way, unit, frame 2.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  /// The distance between the lenses that `ratio` assumes, heights of the camera.
  double assumed_lens_distance = 0;
  /// Change of `ratio` with that distance.
  double per_lens_distance = 0;
  /// What the images of the step tell of that distance.
  LensDistance lens_distance = {};
};

/// A frame that is kept in the map with its features.
struct Keyframe {
  KeyframeId id = kNoId;  ///< Index in the map.
  /// Index of the frame in the input; negative for a frame of the run that made a loaded map.
  int frame_index = 0;
  double timestamp = 0;                      ///< Time of the frame, seconds.
  Rigid3 world_from_camera;                  ///< Pose of the camera.
  std::shared_ptr<const Features> features;  ///< Features of the image; never null in a map.
  /// Landmark that each feature observes; kNoId where it observes none.
  std::vector<LandmarkId> landmarks;
  /// Range of each feature from completed depth; empty where the depth is not completed.
  std::vector<RangePrior> range_priors;
  /// Steps from earlier keyframes to this one; empty where the ground did not show them.
  std::vector<GroundStepFrom> ground_steps;
  /// Pyramid of the image, kept for the newest keyframes only (Map::ForgetImages); else null.
  std::shared_ptr<const SpherePyramid> image;

  /// Whether the frame is one of this run. Otherwise its timestamp is on another clock.
  bool IsOfThisRun() const { return frame_index >= 0; }
  /// Returns the range prior of a feature, with sigma 0 where there is none.
  RangePrior PriorOf(int feature) const {
    return range_priors.empty() ? RangePrior{} : range_priors[feature];
  }
};

/// Returns 1 for each corner (a value of Features::corners, by which the result is indexed) of
/// which a feature on any level observes a landmark, and 0 elsewhere.
std::vector<uint8_t> FindMappedCorners(const Keyframe& keyframe);

/// A point of the map.
struct Landmark {
  LandmarkId id = kNoId;     ///< Index in the map.
  Eigen::Vector3d position;  ///< World frame.
  /// Mean direction from the cameras that observe it towards it, unit vector, world frame; 0 where
  /// these directions cancel.
  Eigen::Vector3d mean_direction;
  /// Range at which it appears on pyramid level 0, world units (RangeAtLevelZero).
  double max_range = 0;
  /// The descriptor of its observations with the smallest median distance to the others.
  Descriptor descriptor{};
  Color color{};                          ///< Colour of the feature by which it was made.
  KeyframeId first_keyframe = kNoId;      ///< The newest keyframe when it was made.
  std::vector<Observation> observations;  ///< Ordered by keyframe.
  /// Null where no image that shows it was kept.
  std::shared_ptr<const LandmarkPatch> patch;
  PatchSlope patch_slope;  ///< Slope of the surface in the patch.
  int visible = 1;         ///< Number of frames in which it should have been found.
  int found = 1;           ///< Number of frames in which it was found.

  /// Returns the observation by a keyframe, or null if the keyframe does not observe the landmark.
  const Observation* FindObservation(KeyframeId from) const;
  /// Returns the observation by a keyframe as above, to be changed.
  Observation* FindObservation(KeyframeId from);
};

/// Returns the range at which a feature of pyramid level l at `range` would appear on level 0.
/// Scales grow by 2^(1/4) per level.
double RangeAtLevelZero(double range, int level);
/// Returns the pyramid level, rounded and not clamped, on which a landmark of that `max_range`
/// appears at `range`: the inverse of RangeAtLevelZero.
int PredictLevel(double max_range, double range);

/// The map: keyframes, landmarks and the observations between them. A map is a value with one owner
/// and without locks. Copies share features, images and patches; everything else is copied.
///
/// Invariant: landmark l lists the observation (k, f) exactly when keyframe k lists l at feature f.
class Map {
 public:
  /// Adds a keyframe that observes no landmark yet, and returns its id. Contract: `features` is not
  /// null.
  KeyframeId AddKeyframe(int frame_index, double timestamp, const Rigid3& world_from_camera,
                         std::shared_ptr<const Features> features);
  /// Removes a keyframe and its observations. Its pose is kept relative to another keyframe,
  /// `successor`: from now on PoseOf(id) follows the successor.
  void RemoveKeyframe(KeyframeId id, KeyframeId successor);

  /// Releases the images of all keyframes except the newest `num_kept`.
  void ForgetImages(int num_kept);

  /// Adds a landmark without observations at a position in the world frame, and returns its id.
  LandmarkId AddLandmark(const Eigen::Vector3d& position, const Color& color);
  /// Removes a landmark and its observations.
  void RemoveLandmark(LandmarkId id);
  /// Moves the observations of `from` to `to` and removes `from`. Where a keyframe observes both,
  /// `to` keeps its own observation. Resolve(from) is `to` from now on. Moved observations are not
  /// yet aligned with the patch of `to`.
  void MergeLandmark(LandmarkId from, LandmarkId to);

  /// Adds an observation. Contract: the feature observes no landmark yet, and the keyframe does not
  /// observe this one.
  void AddObservation(LandmarkId landmark, KeyframeId keyframe, int feature);
  /// Removes an observation. Contract: it exists.
  void RemoveObservation(LandmarkId landmark, KeyframeId keyframe);

  /// Recomputes descriptor, mean direction and range limit from the observations, of which there
  /// must be at least one.
  void UpdateAppearance(LandmarkId id);

  /// Returns whether a keyframe was added under this id and not removed.
  bool HasKeyframe(KeyframeId id) const {
    return id >= 0 && id < keyframe_end() && keyframes_[id].has_value();
  }
  /// Returns whether a landmark was added under this id and not removed.
  bool HasLandmark(LandmarkId id) const {
    return id >= 0 && id < landmark_end() && landmarks_[id].has_value();
  }
  /// Returns a keyframe to be changed. Contract: it exists.
  Keyframe& keyframe(KeyframeId id);
  /// Returns a keyframe. Contract: it exists.
  const Keyframe& keyframe(KeyframeId id) const;
  /// Returns a landmark to be changed. Contract: it exists.
  Landmark& landmark(LandmarkId id);
  /// Returns a landmark. Contract: it exists.
  const Landmark& landmark(LandmarkId id) const;

  /// Returns the landmark that contains `id` now, or kNoId if it was removed.
  LandmarkId Resolve(LandmarkId id) const;
  /// Returns world_from_camera of a keyframe, which may have been removed.
  Rigid3 PoseOf(KeyframeId id) const;
  /// Returns an existing keyframe that represents `id`: itself or its successor.
  KeyframeId LivingKeyframe(KeyframeId id) const;

  /// Returns one more than the largest keyframe id ever given, for loops with HasKeyframe.
  KeyframeId keyframe_end() const { return static_cast<int>(keyframes_.size()); }
  /// Returns one more than the largest landmark id ever given, for loops with HasLandmark.
  LandmarkId landmark_end() const { return static_cast<int>(landmarks_.size()); }
  /// Returns the number of keyframes that exist.
  int num_keyframes() const { return num_keyframes_; }
  /// Returns the number of landmarks that exist.
  int num_landmarks() const { return num_landmarks_; }
  /// Returns the ids of the keyframes that exist, in ascending order.
  std::vector<KeyframeId> KeyframeIds() const;

  /// A keyframe that observes some of the given landmarks.
  struct Covisible {
    KeyframeId keyframe;  ///< Id of the keyframe.
    int shared;           ///< Number of the given landmarks that it observes.
  };
  /// Returns the keyframes other than `except` that observe at least `min_shared` of the landmarks,
  /// and at least one, ordered by that number (largest first; ties: newest first).
  std::vector<Covisible> FindCovisible(std::span<const LandmarkId> landmarks, int min_shared,
                                       KeyframeId except = kNoId) const;

  /// Returns the median range of a keyframe's landmarks from it, world units, or 0 if it has none.
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
