#include "slam/evaluation/cloud_folder.h"

#include <algorithm>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "nn/base/number_text.h"
#include "slam/io/dataset.h"
#include "slam/io/full_sphere.h"
#include "slam/io/ply.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

constexpr const char* kMovingName = "moving";

/// Reads the mask of moving objects, CV_8UC1; empty if there is none.
cv::Mat ReadMoving(const std::filesystem::path& path, cv::Size size) {
  if (!std::filesystem::is_regular_file(path)) return {};
  cv::Mat moving = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
  if (moving.size() != size) {
    throw UserError(path.string() + ": is not a mask of " + ToString(size) + " pixels");
  }
  return moving;
}

}  // namespace

CloudErrors CompareCloudFile(const std::filesystem::path& cloud,
                             const std::filesystem::path& sequence,
                             std::span<const StampedPose> truth, std::span<const PosePair> pairs,
                             int num_threads) {
  std::vector<Eigen::Vector3f> points;
  for (const SurfacePoint& point : ReadSurfacePly(cloud)) points.push_back(point.position);
  AlignLocally(pairs, points);

  std::vector<std::filesystem::path> images;
  for (const auto& entry : std::filesystem::directory_iterator(sequence / Dataset::kDepthName)) {
    if (entry.path().extension() == ".png") images.push_back(entry.path());
  }
  std::ranges::sort(images);
  TrueSurface surface;
  for (const std::filesystem::path& image : images) {
    const std::optional<size_t> index = ParseNumber<size_t>(image.stem().string());
    if (!index || *index >= truth.size()) {
      throw UserError(image.string() + ": is not the number of one of the " +
                      std::to_string(truth.size()) + " true poses");
    }
    const cv::Mat range = ReadDepthImage(image);
    const cv::Mat moving = ReadMoving(sequence / kMovingName / image.filename(), range.size());
    surface.Add(range, moving, truth[*index].world_from_camera);
  }
  std::vector<Eigen::Vector3f> cameras;
  for (const PosePair& pair : pairs) {
    cameras.push_back(pair.truth_from_camera.translation.cast<float>());
  }
  return CompareCloud(points, surface.TakeSurfels(), cameras, num_threads);
}

}  // namespace orb360
