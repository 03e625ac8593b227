#pragma once

#include <span>
#include <vector>

#include "slam/io/trajectory.h"

namespace orb360 {

/// A stretch of a drive on which the camera is again where it was earlier: within 5 m, after more
/// than 50 m of travel.
struct TrueRevisit {
  enum class Direction { kSame, kOpposite, kAcross };
  double begin = 0;  // s
  double end = 0;
  double length = 0;                       // m
  Direction direction = Direction::kSame;  // of the camera, in the middle of the stretch
};

/// In the order of time.
std::vector<TrueRevisit> FindRevisits(std::span<const StampedPose> truth);

/// A loop that a run has closed: when, and when the camera was at that place before, s.
struct LoopTimes {
  double now = 0;
  double before = 0;
};

struct LoopErrors {
  int revisits = 0;
  int closed = 0;  // of these
  int wrong = 0;   // loops whose two ends are more than 10 m apart
};

/// A revisit is closed by a loop that is right and comes on the stretch or within a second of it:
/// it takes a few keyframes to be sure, and a place may be recognised from farther away.
LoopErrors CompareLoops(std::span<const StampedPose> truth, std::span<const LoopTimes> loops);

}  // namespace orb360
