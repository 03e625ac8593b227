#include "slam/stereo/speckles.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <orb360/nn/base/check.h>

namespace orb360 {

void RemoveSpeckles(const SpeckleOptions& options, cv::Mat* disparity) {
  ORB360_CHECK(disparity->type() == CV_32F && disparity->isContinuous(), disparity->type());
  const int width = disparity->cols;
  const auto count = static_cast<int>(disparity->total());
  auto* const values = disparity->ptr<float>();
  const double min_size = options.min_fraction * count;
  std::vector<std::uint8_t> is_visited(static_cast<size_t>(count), 0);
  std::vector<int> segment;
  for (int seed = 0; seed < count; ++seed) {
    if (values[seed] < 0 || is_visited[static_cast<size_t>(seed)] != 0) continue;
    segment.assign(1, seed);
    is_visited[static_cast<size_t>(seed)] = 1;
    for (size_t i = 0; i < segment.size(); ++i) {
      const int at = segment[i];
      const auto visit = [&](int neighbour) {
        if (values[neighbour] < 0 || is_visited[static_cast<size_t>(neighbour)] != 0) return;
        if (std::abs(values[neighbour] - values[at]) > options.max_difference) return;
        is_visited[static_cast<size_t>(neighbour)] = 1;
        segment.push_back(neighbour);
      };
      const int column = at % width;
      if (column > 0) visit(at - 1);
      if (column + 1 < width) visit(at + 1);
      visit((at + width) % count);
      visit((at + count - width) % count);
    }
    if (static_cast<double>(segment.size()) >= min_size) continue;
    for (const int at : segment) values[at] = -1;
  }
}

}  // namespace orb360
