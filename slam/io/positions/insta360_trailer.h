#pragma once

#include <istream>
#include <vector>

#include "slam/io/positions/position_track.h"

namespace orb360 {

/// The positions in the trailer that Insta360's cameras append to a video or image.
struct Insta360Positions {
  std::vector<GeodeticFix> fixes;  ///< Timestamps are UTC, seconds since 1970.
  int num_without_lock = 0;        ///< Measurements that say that there was no fix.
};

/// Reads the GPS record of a file's trailer. There are none in a file without a trailer or without
/// that record; any bytes are accepted. Altitudes have no stated reference.
///
/// The maker documents no format. Known of it, by ExifTool (QuickTimeStream.pl, ProcessInsta360)
/// and by readers of newer cameras' files, all little-endian: the last 72 bytes are 32 zeros, the
/// trailer's size and version (4 bytes each) and 32 letters. Each record is followed by its format
/// and kind (a byte each) and size (4 bytes), the last one by the 72 bytes, so that records are
/// found from the end. Where the last one is of the kind 0, it is an index, and the others do not
/// adjoin: kind, format (a byte each), size, and offset in the trailer (4 bytes each). The kind 7
/// has 53 bytes a measurement: seconds (8), milliseconds (2), `A` with a fix, latitude (8), `N` or
/// `S`, longitude (8), `E` or `W`, speed, course and altitude (8 each).
Insta360Positions ReadInsta360Positions(std::istream& file);

}  // namespace orb360
