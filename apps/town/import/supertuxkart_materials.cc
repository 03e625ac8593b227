#include "apps/town/import/supertuxkart_materials.h"

#include <string_view>
#include <utility>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/town/import/lower_case.h"
#include "apps/town/import/xml_file.h"

namespace orb360::town {
namespace {

KartSurface SurfaceOfShader(std::string_view shader) {
  for (const char* cutout : {"alphatest", "alphablend", "grass", "unlit", "decal"}) {
    if (shader == cutout) return KartSurface::kCutout;
  }
  if (shader == "additive" || shader == "displace") return KartSurface::kNone;
  return KartSurface::kOpaque;
}

}  // namespace

KartMaterials::KartMaterials(std::vector<std::filesystem::path> folders)
    : folders_(std::move(folders)) {
  for (const std::filesystem::path& folder : folders_) {
    const std::filesystem::path file = folder / "materials.xml";
    if (!std::filesystem::exists(file)) continue;
    const pugi::xml_document document = ReadXml(file, "materials");
    for (const pugi::xml_node& material : document.child("materials").children("material")) {
      const std::string name = LowerCase(material.attribute("name").value());
      const std::string shader = LowerCase(material.attribute("shader").value());
      const bool is_new = surfaces_.try_emplace(name, SurfaceOfShader(shader)).second;
      const std::string mask = material.attribute("mask").value();
      if (is_new && !mask.empty()) masks_[name] = mask;
    }
  }
}

KartSurface KartMaterials::SurfaceOf(const std::string& texture) const {
  const auto found = surfaces_.find(LowerCase(texture));
  return found == surfaces_.end() ? KartSurface::kOpaque : found->second;
}

std::string KartMaterials::FileOf(const std::string& texture) const {
  for (const std::filesystem::path& folder : folders_) {
    if (std::filesystem::is_regular_file(folder / texture)) return (folder / texture).string();
  }
  return texture;
}

cv::Mat KartMaterials::MaskedImage(const std::string& texture) const {
  const auto mask_name = masks_.find(LowerCase(texture));
  if (mask_name == masks_.end()) return {};
  cv::Mat colour;
  cv::Mat mask;
  try {
    colour = cv::imread(FileOf(texture), cv::IMREAD_COLOR);
    mask = cv::imread(FileOf(mask_name->second), cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {  // larger than OpenCV allows
  }
  if (colour.empty() || mask.empty()) return {};
  cv::resize(mask, mask, colour.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat image;
  cv::merge(std::vector<cv::Mat>{colour, mask}, image);
  return image;
}

}  // namespace orb360::town
