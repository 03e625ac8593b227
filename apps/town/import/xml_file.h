#pragma once

#include <filesystem>

#include <Eigen/Core>
#include <pugixml.hpp>

namespace orb360::town {

/// Reads an XML file whose outermost element is `root`. Throws UserError that names the file.
pugi::xml_document ReadXml(const std::filesystem::path& path, const char* root);

/// Returns the three numbers of an attribute, or `otherwise` if the element has none. Throws
/// UserError, which begins with the name of the file, if it has others.
Eigen::Vector3f ReadVector(const pugi::xml_node& element, const char* attribute,
                           const Eigen::Vector3f& otherwise, const std::filesystem::path& file);

}  // namespace orb360::town
