#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "slam/io/depth_map_store.h"
#include "slam/pipeline/kept_images.h"
#include "slam/pipeline/keyframe_completion.h"
#include <orb360/slam/map/ground.h>
#include <orb360/slam/pipeline/reconstruction.h>
#include <orb360/slam/pipeline/view_depth_report.h>

namespace orb360 {

struct ViewDepthOptions;

/// Returns how the depth of views is computed: with the height of the camera in the unit of the
/// result where its scale is known.
ViewDepthOptions ViewDepthOptionsOf(const DepthOptions& options, const MetricScale& scale);

/// Keeps the images of tracked frames on disk during a run and computes the dense depth of
/// reference views at its end. Where depth guides mapping (DepthOptions::guides_mapping), it also
/// completes keyframes beside tracking and, while no landmarks show the ground, collects
/// measurements of the ground from them.
class DenseMapper {
 public:
  /// `weights` is a network file, which runs on `device`. `folder` contains the images and depth
  /// maps during the lifetime of the object; it is created here and removed by the destructor.
  /// Throws UserError where the network cannot be read or the folder cannot be created.
  DenseMapper(const std::filesystem::path& weights, const std::filesystem::path& folder,
              const DepthOptions& options, int num_threads, const nn::Device& device = {});

  /// The camera of the images that are completed.
  const EquirectangularCamera& camera() const { return completer_.camera(); }
  const DepthCompleter& completer() const { return completer_; }
  KeptImages& images() { return images_; }

  /// Waits until all images are on disk, and for the completion of a keyframe that has not been
  /// taken, which is dropped.
  void Flush();
  /// Computes the depth of reference views among the frames whose images are kept, with the final
  /// poses and landmarks of `finished` and its `maps` (orb360::ComputeDepth). Nothing happens after
  /// a failure. Throws UserError where the disk fails. Contract: Flush has been called.
  ViewDepthReport ComputeDepth(const Reconstruction& finished, std::span<const Map> maps,
                               const ViewDepthCallbacks& callbacks);

  /// Returns how probable the network finds it that ground is what lies below the camera
  /// (MeanGroundProbability), with the normal `up` of the ground in the world: the median over some
  /// frames along the path, completed from their landmarks. Empty if the network does not tell
  /// ground, after a failure, and where too few landmarks are seen. Contract: as of ComputeDepth.
  std::optional<double> GroundProbability(const Reconstruction& finished, std::span<const Map> maps,
                                          const Eigen::Vector3d& up);

  const DepthMapStore& depth_maps() const { return depth_maps_; }
  /// The error because of which images could not be stored (KeptImages::failure).
  std::exception_ptr failure() const { return images_.failure(); }

  /// Completes keyframes for mapping.
  KeyframeCompletion& completion() { return completion_; }
  const KeyframeCompletion& completion() const { return completion_; }
  /// Adds a keyframe's measurement of the ground under the present map, in the map's world frame
  /// and its present unit of length.
  void AddGround(const DenseGround& ground) { grounds_.push_back(ground); }
  /// Drops the measurements after a change of the map or of its unit of length.
  void ForgetGrounds() { grounds_.clear(); }
  /// Returns the ground that all measurements give together. None where they are too few or too
  /// uncertain.
  std::optional<KnownGround> Ground() const;

 private:
  const std::filesystem::path folder_;
  const DepthOptions options_;
  const int num_threads_;
  std::vector<DenseGround> grounds_;
  DepthMapStore depth_maps_;
  DepthCompleter completer_;
  KeptImages images_;
  /// Declared last, so that its thread ends before the members that it uses.
  KeyframeCompletion completion_;
};

}  // namespace orb360
