#include "apps/town/import/supertuxkart_driveline.h"

#include <array>
#include <string>

#include "apps/town/import/xml_file.h"
#include "nn/base/number_text.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// The corners of a quad: left and right at its beginning, right and left at its end.
using Quad = std::array<Eigen::Vector3f, 4>;

/// Reads a corner: three numbers, or "i:k", which is corner k of the earlier quad i.
Eigen::Vector3f ReadCorner(const pugi::xml_node& element, const char* name,
                           const std::vector<Quad>& earlier, const std::filesystem::path& file) {
  const std::string text = element.attribute(name).value();
  const auto refuse = [&](const std::string& reason) {
    throw UserError(file.string() + ": quad " + std::to_string(earlier.size()) + ": " + name +
                    "=\"" + text + "\": " + reason);
  };
  if (text.empty()) refuse("the corner is missing");
  const size_t colon = text.find(':');
  if (colon == std::string::npos) return ReadVector(element, name, Eigen::Vector3f::Zero(), file);
  const auto quad = ParseNumber<size_t>(text.substr(0, colon));
  const auto corner = ParseNumber<size_t>(text.substr(colon + 1));
  if (!quad || !corner || *quad >= earlier.size() || *corner >= 4)
    refuse("is not a corner of an earlier quad");
  return earlier[*quad][*corner];
}

std::vector<Quad> ReadQuads(const std::filesystem::path& file) {
  const pugi::xml_document document = ReadXml(file, "quads");
  std::vector<Quad> quads;
  for (const pugi::xml_node& element : document.child("quads").children("quad")) {
    quads.push_back({ReadCorner(element, "p0", quads, file), ReadCorner(element, "p1", quads, file),
                     ReadCorner(element, "p2", quads, file),
                     ReadCorner(element, "p3", quads, file)});
  }
  return quads;
}

}  // namespace

std::vector<RoadSection> ReadSuperTuxKartDriveline(const std::filesystem::path& scene_file) {
  const std::filesystem::path folder = std::filesystem::absolute(scene_file).parent_path();
  if (!std::filesystem::exists(scene_file)) throw UserError(scene_file.string() + ": no such file");
  if (!std::filesystem::exists(folder / "quads.xml")) {
    throw UserError(folder.string() +
                    ": has no quads.xml: an arena has no driveline; write a path of your own");
  }
  const std::vector<Quad> quads = ReadQuads(folder / "quads.xml");
  const std::filesystem::path graph = folder / "graph.xml";
  const pugi::xml_document document = ReadXml(graph, "graph");
  const pugi::xml_node loop = document.child("graph").child("edge-loop");
  const auto from = ParseNumber<size_t>(loop.attribute("from").value());
  const auto to = ParseNumber<size_t>(loop.attribute("to").value());
  if (!from || !to || *to >= quads.size() || *to < *from || *to - *from < 2) {
    throw UserError(graph.string() + ": has no <edge-loop> from one quad to a later one of the " +
                    std::to_string(quads.size()) + " in quads.xml");
  }
  std::vector<RoadSection> sections;
  const auto in_right_handed_axes = [](const Eigen::Vector3f& p) {
    return Eigen::Vector3f(p.x(), p.y(), -p.z());
  };
  for (size_t i = *from; i <= *to; ++i)
    sections.push_back({in_right_handed_axes(quads[i][0]), in_right_handed_axes(quads[i][1])});
  return sections;
}

}  // namespace orb360::town
