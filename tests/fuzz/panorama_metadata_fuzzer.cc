// libFuzzer's target for what reads metadata of panoramas: the boxes of an MP4 file around the
// older XML, the segments of a JPEG file with EXIF and XMP, and the XML itself. They must refuse
// with a UserError or give a crop that lies inside of the sphere; nothing else, whatever the bytes.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "slam/io/jpeg_metadata.h"
#include "slam/io/panorama_xml.h"
#include "slam/io/video/gspherical_box.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

void CheckXml(const std::string& xml) {
  for (const char* name : {"GSpherical", "GPano"}) {
    try {
      const std::optional<PanoramaMetadata> metadata = ReadPanoramaXml("file", xml, name);
      if (!metadata || !metadata->crop) continue;
      const PanoramaMetadata::Crop& crop = *metadata->crop;
      constexpr double kRounding = 1e-9;
      for (const double side : {crop.left, crop.top, crop.right, crop.bottom}) {
        if (!(side >= -kRounding && side <= 1.0 + kRounding)) std::abort();
      }
    } catch (const UserError&) {
      // The refusal of what is not allowed.
    }
  }
}

}  // namespace
}  // namespace orb360

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  std::istringstream file(bytes);
  for (int track = 0; track < 2; ++track) {
    if (const auto xml = orb360::FindGSphericalXml(file, track)) orb360::CheckXml(*xml);
  }
  orb360::CheckXml(bytes);
  std::istringstream image(bytes);
  orb360::CheckXml(orb360::ReadJpegMetadata(image).xmp);
  orb360::ExifTime(bytes);
  return 0;
}
