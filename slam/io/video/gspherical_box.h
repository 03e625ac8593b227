#pragma once

#include <iosfwd>
#include <optional>
#include <string>

namespace orb360 {

/// Returns the XML of the number-th video track (from 0) of an MP4 file by the Spherical Video RFC,
/// version 1 (Google): the content of the box `uuid` ffcc8263-f855-4a93-8814-587a02521fdd in the
/// track's box `trak`. FFmpeg's libraries read it too, but neither its crop nor whether the
/// orientation that they give is the sphere's or only that of the initial view. Returns nullopt for
/// anything else, damaged files included. Reads the headers of boxes and no more than 64 KiB of
/// XML.
std::optional<std::string> FindGSphericalXml(std::istream& file, int number);

}  // namespace orb360
