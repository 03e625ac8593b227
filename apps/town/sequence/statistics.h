#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "apps/town/sequence/drive.h"

namespace orb360::town {

/// The revisits of a path: within 5 m of a place, after more than 50 m of travel.
struct Revisits {
  double same_fraction = 0;      ///< of the path, heading within 45 degrees of the earlier one
  double opposite_fraction = 0;  ///< of the path, heading within 45 degrees of the reverse
};
Revisits FindRevisits(std::span<const Rigid3> world_from_camera);

/// Upper ends of the bins of range, metres. There is one more bin for farther points and one for
/// the sky.
inline constexpr std::array<double, 6> kRangeBins = {2.5, 5, 10, 20, 40, 80};

/// Statistics of a drive.
struct DriveStatistics {
  int frames = 0;
  double seconds = 0;
  double path_length = 0;    ///< metres
  double mean_speed = 0;     ///< metres per second, while driving
  double maximum_speed = 0;  ///< metres per second
  double standing_fraction = 0;
  double climb = 0;              ///< metres between the lowest and the highest place
  double turn_rate_95 = 0;       ///< degrees per second, 95th percentile
  double maximum_turn_rate = 0;  ///< degrees per second
  double total_turn = 0;         ///< degrees, all turns to either side added up
  Revisits revisits;
  std::array<double, kRangeBins.size() + 2> range_fractions{};  ///< of the sphere's solid angle
  double moving_fraction = 0;                                   ///< of the solid angle, what moves
  double mean_corners = 0;     ///< corners found in an image, at most as many as were sought
  double minimum_corners = 0;  ///< in the poorest of the images looked at
};

/// Measures a drive: its poses, and ranges and corners (ORB, `sought` of them) in every `every`-th
/// frame.
DriveStatistics MeasureDrive(const Drive& drive, int every, int sought);

/// Returns a Markdown table with a column for each drive.
std::string StatisticsTable(std::span<const std::string> names,
                            std::span<const DriveStatistics> statistics);

}  // namespace orb360::town
