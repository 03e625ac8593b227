#include "slam/stereo/speckles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Disjoint sets of pixels: each points to one of its set, the smallest one to itself.
class PixelSets {
 public:
  explicit PixelSets(int count) : parents_(static_cast<size_t>(count)) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  int Find(int pixel) {
    int parent = parents_[static_cast<size_t>(pixel)];
    while (parent != parents_[static_cast<size_t>(parent)]) {
      parent = parents_[static_cast<size_t>(pixel)] = parents_[static_cast<size_t>(parent)];
      pixel = parent;
      parent = parents_[static_cast<size_t>(pixel)];
    }
    return parent;
  }

  void Join(int first, int second) {
    const int a = Find(first);
    const int b = Find(second);
    parents_[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<int> parents_;
};

}  // namespace

void RemoveSpeckles(const SpeckleOptions& options, cv::Mat* disparity) {
  ORB360_CHECK(disparity->type() == CV_32F && disparity->isContinuous(), disparity->type());
  const int width = disparity->cols;
  const auto count = static_cast<int>(disparity->total());
  auto* const values = disparity->ptr<float>();
  const auto max_difference = static_cast<float>(options.max_difference);
  PixelSets sets(count);
  const auto join = [&](int first, int second) {
    if (values[second] >= 0 && std::abs(values[first] - values[second]) <= max_difference) {
      sets.Join(first, second);
    }
  };
  for (int at = 0; at < count; ++at) {
    if (values[at] < 0) continue;
    if ((at + 1) % width != 0) join(at, at + 1);
    join(at, (at + width) % count);  // The rows are closed.
  }
  std::vector<int> sizes(static_cast<size_t>(count), 0);
  for (int at = 0; at < count; ++at) sizes[static_cast<size_t>(sets.Find(at))] += values[at] >= 0;
  const double min_size = options.min_fraction * count;
  for (int at = 0; at < count; ++at) {
    if (values[at] >= 0 && sizes[static_cast<size_t>(sets.Find(at))] < min_size) values[at] = -1;
  }
}

}  // namespace orb360
