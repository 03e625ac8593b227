#pragma once

namespace orb360 {

class OptionSchema;

struct TriangulationOptions {
  /// Keyframes a new one is matched with, those that share most landmarks.
  int max_neighbours = 10;
  /// Shortest baseline, as a fraction of the median range of the neighbour's landmarks.
  double min_baseline = 0.01;
  /// Matches farther from the epipolar plane than this many standard deviations are wrong.
  double max_plane_sigmas = 2.5;
  /// Angle to the epipole, radians, below which there is no parallax to measure.
  double min_epipole_angle = 0.05;
  /// Parallax of a new landmark: at least this (radians) ...
  double min_parallax = 0.008;
  /// ... and this many standard deviations of it; and at most this (radians), which a wrong match
  /// exceeds easily and a close point seldom.
  double min_parallax_sigmas = 2.5;
  double max_parallax = 1.0;
  /// Ratio of ranges over ratio of feature scales that a match of the same patch may have.
  double max_scale_ratio = 1.3;
  /// Ranges farther from what completed depth says than this many standard deviations are wrong.
  double max_range_sigmas = 4.0;
  int max_distance = 50;  // differing bits
  double ratio = 0.85;
};

/// Registers the keys of the section `triangulation`.
void RegisterOptions(OptionSchema* schema, TriangulationOptions* options);

}  // namespace orb360
