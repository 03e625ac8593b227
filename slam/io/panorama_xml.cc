#include "slam/io/panorama_xml.h"

#include <cmath>

#include "nn/base/number_text.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

std::string Trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(kSpace) - first + 1));
}

/// The numbers of one namespace of the XML of one file.
class Numbers {
 public:
  Numbers(const std::string& name, std::string_view xml, std::string_view xml_namespace)
      : name_(name), xml_(xml), prefix_(std::string(xml_namespace) + ":") {}

  std::optional<std::string> Text(const char* key) const { return XmlValue(xml_, prefix_ + key); }

  std::optional<double> operator()(const char* key) const {
    const std::optional<std::string> text = Text(key);
    if (!text) return std::nullopt;
    const std::optional<double> value = ParseNumber<double>(*text);
    if (value && std::isfinite(*value)) return value;
    throw UserError(name_ + ": its metadata has `" + *text + "` for " + prefix_ + key +
                    ", which is not a number; correct or remove it with a metadata tool");
  }

 private:
  const std::string& name_;
  std::string_view xml_;
  std::string prefix_;
};

/// Returns the missing parts of the sphere, or nullopt if nothing is said or nothing is missing.
std::optional<PanoramaMetadata::Crop> ReadCrop(const std::string& name, const Numbers& number) {
  const std::optional<double> width = number("CroppedAreaImageWidthPixels");
  const std::optional<double> height = number("CroppedAreaImageHeightPixels");
  const std::optional<double> full_width = number("FullPanoWidthPixels");
  const std::optional<double> full_height = number("FullPanoHeightPixels");
  if (!width || !height || !full_width || !full_height) return std::nullopt;
  const double left = number("CroppedAreaLeftPixels").value_or(0.0);
  const double top = number("CroppedAreaTopPixels").value_or(0.0);
  const bool is_inside = *width > 0.0 && *height > 0.0 && left >= 0.0 && top >= 0.0 &&
                         left + *width <= *full_width && top + *height <= *full_height;
  if (!is_inside) {
    throw UserError(name +
                    ": its metadata places the image outside of the full panorama; correct or "
                    "remove it with a metadata tool");
  }
  const PanoramaMetadata::Crop crop{left / *full_width, top / *full_height,
                                    1.0 - (left + *width) / *full_width,
                                    1.0 - (top + *height) / *full_height};
  const bool is_whole = *width == *full_width && *height == *full_height;
  return is_whole ? std::nullopt : std::optional(crop);
}

}  // namespace

std::optional<std::string> XmlValue(std::string_view xml, std::string_view name) {
  for (size_t at = xml.find(name); at != std::string_view::npos; at = xml.find(name, at + 1)) {
    std::string_view rest = xml.substr(at + name.size());
    const bool is_element = at > 0 && xml[at - 1] == '<';
    if (is_element && rest.starts_with('>')) {
      return Trimmed(rest.substr(1, rest.find('<') - 1));
    }
    rest.remove_prefix(std::min(rest.find_first_not_of(kSpace), rest.size()));
    if (is_element || !rest.starts_with('=')) continue;
    rest.remove_prefix(1);
    rest.remove_prefix(std::min(rest.find_first_not_of(kSpace), rest.size()));
    if (!rest.starts_with('"') && !rest.starts_with('\'')) continue;
    return Trimmed(rest.substr(1, rest.find(rest.front(), 1) - 1));
  }
  return std::nullopt;
}

std::optional<PanoramaMetadata> ReadPanoramaXml(const std::string& name, std::string_view xml,
                                                std::string_view xml_namespace) {
  const Numbers number(name, xml, xml_namespace);
  const std::optional<std::string> projection = number.Text("ProjectionType");
  if (!projection) return std::nullopt;
  if (*projection != "equirectangular") {
    throw UserError(name + ": its metadata calls its projection `" + *projection +
                    "`; export the recording as equirectangular");
  }
  PanoramaMetadata metadata;
  metadata.is_equirectangular = true;
  metadata.crop = ReadCrop(name, number);
  // Absent in GPano; the older XML of videos allows two layouts and puts the left eye first.
  const std::string stereo = number.Text("StereoMode").value_or("mono");
  if (stereo == "top-bottom") metadata.stereo = StereoMode::kTopBottom;
  if (stereo == "left-right") metadata.stereo = StereoMode::kLeftRight;
  return metadata;
}

}  // namespace orb360
