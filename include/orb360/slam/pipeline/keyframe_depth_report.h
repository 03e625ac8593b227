#pragma once

#include <functional>

namespace orb360 {

/// Receives before each keyframe how many of how many are done. False makes the rest faster and
/// less exact.
using KeyframeProgress = std::function<bool(int done, int count)>;

/// Of how many keyframes stereo has measured a part, and why not of the others.
struct KeyframeDepthReport {
  int measured = 0;         ///< Keyframes of which stereo has measured a part.
  int without_sources = 0;  ///< Those without two frames around them at a useful distance.
  int unseen = 0;           ///< Those of which two frames agree on little, for want of texture.
};

}  // namespace orb360
