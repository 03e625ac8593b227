#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "apps/town/import/quake_bsp.h"
#include "apps/town/import/quake_shader.h"
#include "apps/town/import/source_scene.h"

namespace orb360::town {

/// How the faces of a surface are shown.
struct QuakeSurface {
  bool is_shown = false;
  bool is_lit = true;  ///< by baked light; otherwise it shines with the colour of its texture
  Eigen::Vector2f texture_scale = Eigen::Vector2f::Ones();
  SourceMaterial material;
};

/// The images of a game's folder: by their path in it without extension, in lower case.
using QuakeImages = std::map<std::string, std::filesystem::path>;

/// Finds the images (TGA, JPEG, PNG) in the folders of a game that contain textures. The paths
/// begin with `folder`.
QuakeImages FindQuakeImages(const std::filesystem::path& folder);

/// Decides how a surface is shown. The sky, portals, fog, billboards, what is never drawn, and what
/// only brightens or darkens what lies behind it (beams, flames, stains) are not shown, except
/// liquids. The texture is the image of the first stage that is neither baked light nor a
/// reflection, or what the editor shows, or the image of the surface's own name.
QuakeSurface ChooseQuakeSurface(const QuakeShaderName& name, const QuakeShaders& shaders,
                                const QuakeImages& images);

}  // namespace orb360::town
