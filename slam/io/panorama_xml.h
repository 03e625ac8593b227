#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "slam/io/panorama_layout.h"

namespace orb360 {

/// Returns the text under a name with its prefix, such as "GPano:FullPanoWidthPixels", in XML or
/// RDF/XML: `<name>text</name>` or `name="text"`. Returns nullopt if it is absent. This is no
/// parser of XML: the two formats use nothing else of it.
std::optional<std::string> XmlValue(std::string_view xml, std::string_view name);

/// Reads the metadata of a panorama from the XMP of an image, namespace "GPano" (Google, Photo
/// Sphere XMP Metadata), or from the XML of a video, namespace "GSpherical" (Google, Spherical
/// Video RFC, version 1). Returns nullopt if the namespace is not used. The initial view does not
/// turn the sphere and is ignored; so is GPano's pose, which cameras measure for each image: turned
/// by it, what moves with the camera would move in the images. Throws UserError, whose message
/// begins with `name`, for another projection and for a crop that lies outside of the sphere.
std::optional<PanoramaMetadata> ReadPanoramaXml(const std::string& name, std::string_view xml,
                                                std::string_view xml_namespace);

}  // namespace orb360
