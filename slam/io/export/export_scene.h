#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slam/io/export/view.h"
#include "slam/io/sparse_model.h"

namespace orb360 {

/// What an exporter of a scene writes.
struct ExportScene {
  /// The frames whose images are exported, all of one map, with what they observe of the landmarks.
  SparseModel model;
  /// The cameras. Each frame has one image of each.
  std::vector<View> views;
  /// Extension of the images' names, with the dot.
  std::string extension = ".jpg";
  bool has_masks = false;
  /// Points that replace the landmarks, such as a thinned dense cloud. They have no observations.
  std::optional<std::vector<ColoredLandmark>> cloud;
  /// Indices of frames with a depth map, ascending.
  std::vector<int> frames_with_depth;

  /// The points that are written.
  const std::vector<ColoredLandmark>& points() const { return cloud ? *cloud : model.points; }
};

/// Folders of what belongs to images, beside the files of the model.
inline constexpr const char* kImagesFolder = "images";
inline constexpr const char* kMasksFolder = "masks";
inline constexpr const char* kDepthFolder = "depth";

/// Returns the name of an image, relative to the folder of images: `front/000012.jpg`, or
/// `000012.jpg` of a panorama, by the index of the frame.
std::string ImageName(const ExportScene& scene, const PosedFrame& frame, const View& view);

/// Returns the name of the mask of an image, relative to the folder of masks. COLMAP and OpenSfM
/// look for it under the name of the image with `.png` at its end.
std::string MaskName(const std::string& image_name);

/// Returns the name of the depth map of an image, relative to the folder of depth maps.
std::string DepthName(const PosedFrame& frame, const View& view);

/// Returns the number of the map with most keyframes; of several the first. Contract: there is a
/// frame.
int LargestMap(const SparseModel& model);

/// Returns the model with those of its frames for which `is_kept` is true, and with all points that
/// one of them observes. The points are numbered anew in their order.
SparseModel KeepFrames(SparseModel model, const std::vector<bool>& is_kept);

}  // namespace orb360
