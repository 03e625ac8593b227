#include "slam/evaluation/depth_folder.h"

#include <algorithm>
#include <vector>

#include "slam/io/full_sphere.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {

DepthFolderErrors CompareDepthFolders(const std::filesystem::path& truth,
                                      const std::filesystem::path& estimate) {
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
    if (range.size() != true_range.size()) {
      throw UserError((estimate / name).string() + ": is " + ToString(range.size()) +
                      ", its ground truth " + ToString(true_range.size()));
    }
    result.errors += CompareDepth(true_range, range);
    ++result.images;
  }
  return result;
}

}  // namespace orb360
