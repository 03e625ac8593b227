#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace orb360::town {

/// How SuperTuxKart draws a surface, as far as an image of it without effects needs it.
enum class KartSurface {
  kOpaque,  ///< the texture's alpha is a gloss or nothing
  kCutout,  ///< absent where the texture's alpha is below one half
  kNone,    ///< a glow or a haze, which has no surface
};

/// The materials of folders of SuperTuxKart.
class KartMaterials {
 public:
  /// Reads materials.xml of each folder that has one. The first folder that describes a texture
  /// decides. Throws UserError.
  explicit KartMaterials(std::vector<std::filesystem::path> folders);

  KartSurface SurfaceOf(const std::string& texture) const;
  /// Returns the file of a texture, or its bare name if it is in none of the folders.
  std::string FileOf(const std::string& texture) const;
  /// Returns a texture whose alpha is in an image of its own, its mask, with this alpha. Returns an
  /// empty image for other textures, and if one of the two files cannot be read.
  cv::Mat MaskedImage(const std::string& texture) const;

 private:
  std::vector<std::filesystem::path> folders_;
  // By the name of the texture in small letters.
  std::map<std::string, KartSurface> surfaces_;
  std::map<std::string, std::string> masks_;
};

}  // namespace orb360::town
