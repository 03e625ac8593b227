#pragma once

#include <string>

#include "slam/io/panorama_layout.h"
#include "slam/io/video/image_orientation.h"
#include "slam/io/video/libav.h"

namespace orb360 {

/// Reads what a video track says of its panorama: the boxes `st3d` and `sv3d` of MP4 and the
/// elements of Matroska (Google, Spherical Video V2 RFC), and the older XML of MP4
/// (gspherical_box.h) for what those do not say. `path` is the file, `number` counts its video
/// tracks from 0. Throws UserError for a projection that is not equirectangular, for stereo in
/// which both eyes are not one image beside the other, and as ReadPanoramaXml.
PanoramaMetadata ReadSphericalMetadata(const std::string& path, int number, const AVStream& stream);

/// Returns how the images of the track are turned to be shown.
ImageOrientation ReadOrientation(const AVStream& stream);

}  // namespace orb360
