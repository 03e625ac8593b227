#include "slam/pipeline/self_mask.h"

#include <algorithm>
#include <cmath>

#include "slam/features/static_region.h"

namespace orb360 {

cv::Mat FindSelfMask(const std::string& input, const SequenceOptions& options, double frame_rate) {
  // Interval between the images, s. Walking and driving then cause motion of several pixels.
  constexpr double kInterval = 0.2;
  constexpr double kLongest = 10.0;  // s
  SequenceOptions sampled = options;
  sampled.stride = std::max(options.stride, static_cast<int>(std::lround(kInterval * frame_rate)));
  double source_frames = kLongest * frame_rate;
  if (options.max_frames > 0) {
    source_frames = std::min(source_frames, 1.0 * options.max_frames * options.stride);
  }
  sampled.max_frames = 1 + static_cast<int>(source_frames / sampled.stride);
  const std::unique_ptr<Sequence> sequence = OpenSequence(input, sampled);
  StaticRegionDetector detector;
  while (!detector.HasEvidence()) {
    const std::optional<Frame> frame = sequence->Next();
    if (!frame) break;
    detector.Add(frame->image);
  }
  return detector.Mask(sequence->image_size());
}

}  // namespace orb360
