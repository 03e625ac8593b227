#include "slam/pipeline/self_mask.h"

#include <algorithm>
#include <cmath>

#include "slam/features/static_region.h"

namespace orb360 {

cv::Mat FindSelfMask(const std::string& input, SequenceOptions options) {
  constexpr double kInterval = 0.2;   // s: walking and driving then show as pixels of motion
  constexpr double kLongest = 10.0;  // s
  const double frame_rate = OpenSequence(input, options)->frame_rate();
  const int step = std::max(1, static_cast<int>(std::lround(kInterval * frame_rate)));
  options.stride = options.stride * std::max(1, step / options.stride);
  const int longest = 1 + static_cast<int>(kLongest * frame_rate / options.stride);
  options.max_frames =
      options.max_frames > 0 ? std::min(longest, 1 + options.max_frames * step / options.stride)
                             : longest;
  const std::unique_ptr<Sequence> sequence = OpenSequence(input, options);
  StaticRegionDetector detector;
  while (!detector.HasEvidence()) {
    const std::optional<Frame> frame = sequence->Next();
    if (!frame) break;
    detector.Add(frame->image);
  }
  return detector.Mask(sequence->image_size());
}

}  // namespace orb360
