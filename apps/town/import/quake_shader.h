#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

/// How a stage of a surface joins what lies below it.
enum class QuakeBlend {
  kReplace,  ///< covers it
  kAlpha,    ///< covers it where its own alpha says so
  kFilter,   ///< multiplies it
  kAdd,      ///< adds light to it
};

/// One of the layers of a surface.
struct QuakeStage {
  std::string image;  ///< empty for none; "$lightmap" for the baked light
  QuakeBlend blend = QuakeBlend::kReplace;
  bool has_holes = false;      ///< absent where the image is transparent
  bool is_reflection = false;  ///< the image is that of the surroundings
  bool takes_vertex_light = false;
  Eigen::Vector2f scale = Eigen::Vector2f::Ones();  ///< factor on texture coordinates
};

/// The description of a surface by a script.
struct QuakeShader {
  std::set<std::string> parameters;  ///< "nodraw", "sky", "water", ...
  std::string editor_image;          ///< what the editor of maps shows; empty for none
  bool is_portal = false;            ///< shows another place
  bool is_billboard = false;         ///< turns towards the camera
  std::vector<QuakeStage> stages;
};

/// By name, in lower case.
using QuakeShaders = std::map<std::string, QuakeShader>;

/// Adds the shaders of a script; of equal names the first counts. What is not known, or cut off, is
/// ignored.
void ParseQuakeShaders(std::string_view script, QuakeShaders* shaders);

/// Reads all files *.shader of a folder in the order of their names; none if there is no such
/// folder.
QuakeShaders ReadQuakeShaders(const std::filesystem::path& folder);

}  // namespace orb360::town
