#pragma once

#include <span>
#include <vector>

#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// A stretch of a drive on which the camera is where it was before: within 5 m, after more than 50
/// m of travel.
struct TrueRevisit {
  enum class Direction { kSame, kOpposite, kAcross };
  double begin = 0;  // s
  double end = 0;
  double length = 0;                       // m
  Direction direction = Direction::kSame;  // of the camera, in the middle of the stretch
};

/// Returns the revisits in the order of time.
std::vector<TrueRevisit> FindRevisits(std::span<const StampedPose> truth);

/// Times of a loop that a run closed: of the revisit, and of the earlier visit, s.
struct LoopTimes {
  double now = 0;
  double before = 0;
};

struct LoopErrors {
  int revisits = 0;
  int closed = 0;  // of these
  int wrong = 0;   // loops whose two ends are more than 10 m apart
};

/// Compares loops with revisits. A revisit is closed by a correct loop on the stretch or within a
/// second of it: a few keyframes are needed for certainty, and a place may be recognised from
/// farther away.
LoopErrors CompareLoops(std::span<const StampedPose> truth, std::span<const LoopTimes> loops);

}  // namespace orb360
