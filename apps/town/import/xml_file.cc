#include "apps/town/import/xml_file.h"

#include <sstream>
#include <string>

#include <orb360/nn/base/check.h>

namespace orb360::town {

pugi::xml_document ReadXml(const std::filesystem::path& path, const char* root) {
  if (!std::filesystem::is_regular_file(path)) throw UserError(path.string() + ": no such file");
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_file(path.c_str());
  if (!result) {
    throw UserError(path.string() + ": byte " + std::to_string(result.offset) + ": " +
                    result.description());
  }
  if (!document.child(root))
    throw UserError(path.string() + ": has no element <" + root + "> outermost");
  return document;
}

Eigen::Vector3f ReadVector(const pugi::xml_node& element, const char* attribute,
                           const Eigen::Vector3f& otherwise, const std::filesystem::path& file) {
  const pugi::xml_attribute value = element.attribute(attribute);
  if (!value) return otherwise;
  std::istringstream text(value.value());
  Eigen::Vector3f vector;
  if (!(text >> vector.x() >> vector.y() >> vector.z()) || !(text >> std::ws).eof()) {
    throw UserError(file.string() + ": <" + element.name() + "> has " + attribute + "=\"" +
                    value.value() + "\": expected three numbers");
  }
  return vector;
}

}  // namespace orb360::town
