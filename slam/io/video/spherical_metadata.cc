#include "slam/io/video/spherical_metadata.h"

#include <algorithm>
#include <fstream>

#include "slam/io/panorama_xml.h"
#include "slam/io/video/gspherical_box.h"
#include <orb360/nn/base/check.h>

extern "C" {
#include <libavutil/spherical.h>
#include <libavutil/stereo3d.h>
}

namespace orb360 {
namespace {

/// Returns side data of a stream, or null.
template <typename T>
const T* SideData(const AVStream& stream, AVPacketSideDataType type) {
  size_t size = 0;
  const std::uint8_t* data = av_stream_get_side_data(&stream, type, &size);
  return data != nullptr && size >= sizeof(T) ? reinterpret_cast<const T*>(data) : nullptr;
}

void ReadStereo(const std::string& path, const AVStereo3D& stereo, PanoramaMetadata* metadata) {
  switch (stereo.type) {
    case AV_STEREO3D_2D:
      return;
    case AV_STEREO3D_TOPBOTTOM:
      metadata->stereo = StereoMode::kTopBottom;
      break;
    case AV_STEREO3D_SIDEBYSIDE:
      metadata->stereo = StereoMode::kLeftRight;
      break;
    default:
      throw UserError(path + ": is stereo of the kind `" + av_stereo3d_type_name(stereo.type) +
                      "`; export one eye, or both one above or beside the other");
  }
  metadata->is_left_first = (stereo.flags & AV_STEREO3D_FLAG_INVERT) == 0;
}

void ReadProjection(const std::string& path, const AVSphericalMapping& mapping,
                    PanoramaMetadata* metadata) {
  constexpr double kFixed32 = 4294967296.0;  // 0.32 fixed point
  constexpr double kFixed16 = 65536.0;       // 16.16 fixed point
  if (mapping.projection != AV_SPHERICAL_EQUIRECTANGULAR &&
      mapping.projection != AV_SPHERICAL_EQUIRECTANGULAR_TILE) {
    throw UserError(path + ": its metadata calls its projection `" +
                    av_spherical_projection_name(mapping.projection) +
                    "`; export the recording as equirectangular");
  }
  metadata->is_equirectangular = true;
  if (mapping.projection == AV_SPHERICAL_EQUIRECTANGULAR_TILE) {
    metadata->crop = {mapping.bound_left / kFixed32, mapping.bound_top / kFixed32,
                      mapping.bound_right / kFixed32, mapping.bound_bottom / kFixed32};
  }
  metadata->yaw = mapping.yaw / kFixed16;
  metadata->pitch = mapping.pitch / kFixed16;
  metadata->roll = mapping.roll / kFixed16;
}

/// Whether the orientation that FFmpeg gives is the initial view of the older XML, which it reads
/// as whole degrees.
bool IsInitialView(std::string_view xml, const PanoramaMetadata& metadata) {
  const auto is_same = [&](const char* name, double degrees) {
    const std::string text = XmlValue(xml, name).value_or("0");
    return std::strtol(text.c_str(), nullptr, 10) == degrees;
  };
  return is_same("GSpherical:InitialViewHeadingDegrees", metadata.yaw) &&
         is_same("GSpherical:InitialViewPitchDegrees", metadata.pitch) &&
         is_same("GSpherical:InitialViewRollDegrees", metadata.roll);
}

}  // namespace

PanoramaMetadata ReadSphericalMetadata(const std::string& path, int number,
                                       const AVStream& stream) {
  PanoramaMetadata metadata;
  if (const auto* stereo = SideData<AVStereo3D>(stream, AV_PKT_DATA_STEREO3D)) {
    ReadStereo(path, *stereo, &metadata);
  }
  if (const auto* mapping = SideData<AVSphericalMapping>(stream, AV_PKT_DATA_SPHERICAL)) {
    ReadProjection(path, *mapping, &metadata);
  }
  std::ifstream file(path, std::ios::binary);
  const std::optional<std::string> xml = FindGSphericalXml(file, number);
  if (!xml) return metadata;
  if (IsInitialView(*xml, metadata)) metadata.yaw = metadata.pitch = metadata.roll = 0.0;
  const std::optional<PanoramaMetadata> older = ReadPanoramaXml(path, *xml, "GSpherical");
  if (!older) return metadata;
  metadata.is_equirectangular = true;
  if (!metadata.crop) metadata.crop = older->crop;
  if (metadata.stereo == StereoMode::kMono) metadata.stereo = older->stereo;
  return metadata;
}

ImageOrientation ReadOrientation(const AVStream& stream) {
  using Matrix = std::array<std::int32_t, 9>;
  const auto* matrix = SideData<Matrix>(stream, AV_PKT_DATA_DISPLAYMATRIX);
  return matrix != nullptr ? FromDisplayMatrix(*matrix) : ImageOrientation();
}

}  // namespace orb360
