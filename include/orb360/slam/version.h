#pragma once

#include <string_view>

/// Visual SLAM for 360-degree video on the CPU. System (slam/pipeline/system.h) is the whole of it;
/// the other headers are its inputs, options and results, and parts that are of use alone. Unless a
/// comment says otherwise, the camera frame is -X forward, +Y right, +Z up, lengths are in the unit
/// of the map (the metre once its scale is known), times in seconds and angles in radians.
namespace orb360 {

/// The version of the library by `git describe`: that of a release, such as "0.1.0", or with the
/// commits since and the last of them, "0.1.0-12-g1a2b3c4d5"; "-dirty" for uncommitted changes.
std::string_view Version();

}  // namespace orb360
