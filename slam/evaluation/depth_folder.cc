#include "slam/evaluation/depth_folder.h"

#include <algorithm>
#include <vector>

#include "slam/io/full_sphere.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

void RequireSize(const std::filesystem::path& path, const cv::Mat& image, cv::Size truth) {
  if (image.size() == truth) return;
  throw UserError(path.string() + ": is " + ToString(image.size()) + ", its ground truth " +
                  ToString(truth));
}

}  // namespace

DepthFolderErrors CompareDepthFolders(const std::filesystem::path& truth,
                                      const std::filesystem::path& estimate,
                                      const std::filesystem::path& confidence,
                                      const std::filesystem::path& source) {
  std::vector<std::filesystem::path> names;
  for (const auto& entry : std::filesystem::directory_iterator(estimate)) {
    const std::filesystem::path name = entry.path().filename();
    if (name.extension() == ".png" && std::filesystem::exists(truth / name)) names.push_back(name);
  }
  std::ranges::sort(names);  // Sums of floating-point numbers depend on the order.

  DepthFolderErrors result;
  for (const std::filesystem::path& name : names) {
    const cv::Mat true_range = ReadDepthImage(truth / name);
    const cv::Mat range = ReadDepthImage(estimate / name);
    RequireSize(estimate / name, range, true_range.size());
    const DepthErrors errors = CompareDepth(true_range, range);
    result.errors += errors;
    result.images.push_back({name.string(), errors.total});
    if (confidence.empty() || !std::filesystem::exists(confidence / name)) continue;
    const cv::Mat stated = ReadFractionImage(confidence / name);
    RequireSize(confidence / name, stated, true_range.size());
    if (!result.calibration) result.calibration.emplace();
    *result.calibration += CompareConfidence(true_range, range, stated);
    if (source.empty() || !std::filesystem::exists(source / name)) continue;
    const cv::Mat sources = ReadSourceImage(source / name);
    RequireSize(source / name, sources, true_range.size());
    for (const RangeSource known_by : kRangeSources) {
      cv::Mat selected = stated.clone();
      selected.setTo(0, sources != static_cast<double>(known_by));
      const DepthCalibration part = CompareConfidence(true_range, range, selected);
      if (part.solid_angle() > 0) result.by_source[known_by] += part;
    }
  }
  return result;
}

}  // namespace orb360
