#pragma once

namespace orb360 {

class OptionSchema;

/// How landmarks are made from matches of two keyframes (paper III-A,
/// docs/concepts/triangulation.md).
struct TriangulationOptions {
  /// Largest number of keyframes with which a new one is matched: those that share most landmarks.
  int max_neighbours = 10;
  /// Shortest baseline, as a fraction of the median range of the neighbour's landmarks.
  double min_baseline = 0.01;
  /// Largest angle of a match to its epipolar plane, in standard deviations of it (paper Eq. 7).
  double max_plane_sigmas = 2.5;
  /// Least angle of a match to the epipole, radians. Nearer to it there is no parallax to measure.
  double min_epipole_angle = 0.05;
  /// Least parallax of a new landmark, radians.
  double min_parallax = 0.008;
  /// Least parallax of a new landmark in standard deviations of the parallax.
  double min_parallax_sigmas = 2.5;
  /// Largest parallax of a new landmark, radians. Wrong matches often exceed it, close points
  /// seldom.
  double max_parallax = 1.0;
  /// Largest factor by which the ratio of the ranges may differ from the ratio of the features'
  /// scales. For the same patch they are equal.
  double max_scale_ratio = 1.3;
  /// Largest difference between the logarithms of a match's range and of its completed range, in
  /// standard deviations of the difference.
  double max_range_sigmas = 4.0;
  /// Largest Hamming distance of two descriptors that match, bits of 256.
  int max_distance = 50;
  /// Largest ratio of the distance of the best match to that of the second best on the same level.
  double ratio = 0.85;
};

/// Registers the keys of the section `triangulation`.
void RegisterOptions(OptionSchema* schema, TriangulationOptions* options);

}  // namespace orb360
