#include "apps/town/import/quake_surface.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "apps/town/import/lower_case.h"
#include "apps/town/import/texture_file.h"

namespace orb360::town {
namespace {

/// Returns the path of an image without its extension, as a key of QuakeImages.
std::string KeyOf(const std::string& image) {
  return LowerCase(std::filesystem::path(image).replace_extension().generic_string());
}

bool IsLiquid(const QuakeShaderName& name, const QuakeShader& shader) {
  constexpr uint32_t kLiquids = QuakeBits::kLava | QuakeBits::kSlime | QuakeBits::kWater;
  return (name.contents & kLiquids) != 0 ||
         std::any_of(shader.parameters.begin(), shader.parameters.end(), [](const auto& parameter) {
           return parameter == "water" || parameter == "slime" || parameter == "lava";
         });
}

bool IsHidden(const QuakeShaderName& name, const QuakeShader& shader) {
  constexpr uint32_t kHidden =
      QuakeBits::kSky | QuakeBits::kNoDraw | QuakeBits::kHint | QuakeBits::kSkip;
  if ((name.flags & kHidden) != 0 || (name.contents & QuakeBits::kFog) != 0) return true;
  if (shader.is_portal || shader.is_billboard) return true;
  for (const char* parameter : {"sky", "nodraw", "hint", "skip", "fog", "areaportal"})
    if (shader.parameters.contains(parameter)) return true;
  const std::string lower = LowerCase(name.name);
  for (const char* tool :
       {"caulk", "clip", "hint", "trigger", "nodraw", "skip", "portal", "origin"})
    if (lower.starts_with(std::string("textures/common/") + tool)) return true;
  return lower.empty() || lower == "noshader";
}

/// Returns the layer that shows the surface's own texture; null if there is none.
const QuakeStage* TextureStage(const QuakeShader& shader) {
  const auto is_image = [](const QuakeStage& s) { return !s.image.empty() && s.image[0] != '$'; };
  const QuakeStage* found = nullptr;
  for (const QuakeStage& stage : shader.stages) {
    if (!is_image(stage)) continue;
    if (!stage.is_reflection) return &stage;
    if (found == nullptr) found = &stage;
  }
  return found;
}

}  // namespace

QuakeImages FindQuakeImages(const std::filesystem::path& folder) {
  // Of several images of a name the first kind is shown, as in the game.
  constexpr std::array<const char*, 4> kExtensions = {".tga", ".jpg", ".jpeg", ".png"};
  std::map<std::string, std::pair<size_t, std::filesystem::path>> found;
  for (const char* part : {"textures", "models", "env", "gfx", "sprites"}) {
    std::error_code error;
    std::filesystem::recursive_directory_iterator entry(folder / part, error);
    for (; !error && entry != std::filesystem::recursive_directory_iterator();
         entry.increment(error)) {
      const auto* const extension =
          std::find(kExtensions.begin(), kExtensions.end(), LowerExtension(entry->path()));
      if (extension == kExtensions.end()) continue;
      const std::string key = KeyOf(entry->path().lexically_relative(folder).generic_string());
      std::pair candidate(static_cast<size_t>(extension - kExtensions.begin()), entry->path());
      const auto [place, is_new] = found.try_emplace(key, candidate);
      if (!is_new) place->second = std::min(place->second, candidate);
    }
  }
  QuakeImages images;
  for (auto& [key, image] : found) images.emplace(key, std::move(image.second));
  return images;
}

QuakeSurface ChooseQuakeSurface(const QuakeShaderName& name, const QuakeShaders& shaders,
                                const QuakeImages& images) {
  const auto entry = shaders.find(LowerCase(name.name));
  const QuakeShader shader = entry == shaders.end() ? QuakeShader() : entry->second;
  QuakeSurface surface;
  surface.material.is_liquid = IsLiquid(name, shader);
  surface.is_shown = !IsHidden(name, shader);
  bool has_holes = false;
  if (!shader.stages.empty()) {
    const QuakeStage& lowest = shader.stages.front();
    has_holes = lowest.has_holes || lowest.blend == QuakeBlend::kAlpha;
    surface.is_shown &=
        has_holes || lowest.blend == QuakeBlend::kReplace || surface.material.is_liquid;
    surface.is_lit =
        std::any_of(shader.stages.begin(), shader.stages.end(), [](const QuakeStage& stage) {
          return stage.image == "$lightmap" || stage.takes_vertex_light;
        });
  }
  surface.material.is_opaque = !has_holes || surface.material.is_liquid;

  std::vector<std::string> candidates;
  if (const QuakeStage* stage = TextureStage(shader)) {
    candidates.push_back(stage->image);
    surface.texture_scale = stage->scale;
  }
  if (!shader.editor_image.empty()) candidates.push_back(shader.editor_image);
  candidates.push_back(name.name);
  for (const std::string& candidate : candidates) {
    const auto image = images.find(KeyOf(candidate));
    if (image == images.end()) continue;
    surface.material.texture = std::filesystem::absolute(image->second).string();
    return surface;
  }
  // As a file beside the folder of maps, for the message that it is missing.
  surface.material.texture = "../" + candidates.front();
  return surface;
}

}  // namespace orb360::town
