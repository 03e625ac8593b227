#include "apps/town/import/import_scenery.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/town/import/ac3d.h"
#include "apps/town/import/assimp_scene.h"
#include "apps/town/import/sgi_image.h"
#include "slam/check.h"

namespace orb360::town {
namespace {

std::string LowerExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// CV_8UC4, blue first.
cv::Mat4b ReadTexture(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw UserError(path.string() + ": no such file");
  const std::string extension = LowerExtension(path);
  for (const char* sgi : {".rgb", ".rgba", ".sgi", ".bw"}) {
    if (extension == sgi) return ReadSgiImage(path);
  }
  cv::Mat image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  if (image.empty()) throw UserError(path.string() + ": cannot be read as an image");
  if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 1.0 / 257);
  cv::Mat4b result;
  if (image.channels() == 1) cv::cvtColor(image, result, cv::COLOR_GRAY2BGRA);
  if (image.channels() == 3) cv::cvtColor(image, result, cv::COLOR_BGR2BGRA);
  if (image.channels() == 4) result = image;
  if (result.empty())
    throw UserError(path.string() + ": has a number of channels that is not read");
  return result;
}

/// Sides become powers of two, as Texture needs them.
Texture ToTexture(cv::Mat4b image, bool* has_holes) {
  constexpr int kMaximumSide = 4096;
  const auto power = [=](int side) {
    return std::min(static_cast<int>(std::bit_ceil(static_cast<unsigned>(side))), kMaximumSide);
  };
  const cv::Size size(power(image.cols), power(image.rows));
  if (size != image.size()) cv::resize(image, image, size, 0, 0, cv::INTER_LINEAR);
  *has_holes = false;
  std::vector<Rgba> texels;
  texels.reserve(image.total());
  for (int row = image.rows - 1; row >= 0; --row) {
    for (int column = 0; column < image.cols; ++column) {
      const cv::Vec4b& pixel = image(row, column);
      Rgba texel = Srgb(pixel[2], pixel[1], pixel[0]);
      texel.a = static_cast<float>(pixel[3]) / 255;
      *has_holes |= texel.a < 0.5F;
      texels.push_back(texel);
    }
  }
  return Texture(image.cols, image.rows, std::move(texels));
}

/// Adds the materials to the palette, in their order.
void AddMaterials(const SourceScene& source, const std::filesystem::path& folder,
                  std::vector<std::string>* missing, Palette* palette) {
  struct Loaded {
    uint16_t texture;
    bool has_holes;
  };
  std::map<std::string, Loaded> loaded;
  const auto plain = [](float level) { return Texture(1, 1, {Rgba{level, level, level, 1}}); };
  palette->textures.push_back(plain(1));  // for surfaces without a texture
  loaded[""] = {0, false};
  for (const SourceMaterial& material : source.materials) {
    auto [entry, is_new] = loaded.try_emplace(material.texture);
    if (is_new) {
      bool has_holes = false;
      try {
        palette->textures.push_back(ToTexture(ReadTexture(folder / material.texture), &has_holes));
      } catch (const UserError& error) {
        missing->push_back(error.what());
        palette->textures.push_back(plain(0.4F));
      }
      entry->second = {static_cast<uint16_t>(palette->textures.size() - 1), has_holes};
    }
    palette->all.push_back({.texture = entry->second.texture, .cutout = entry->second.has_holes});
  }
}

/// Area-weighted means of the normals of the faces that share a vertex.
std::vector<Vector3f> SmoothNormals(const std::vector<Vector3f>& positions,
                                    const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<Vector3f> normals(positions.size(), Vector3f::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vector3f normal = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const uint32_t corner : {a, b, c}) normals[corner] += normal;
  }
  for (Vector3f& normal : normals) {
    normal.stableNormalize();
    if (!normal.allFinite() || normal.squaredNorm() < 0.5F) normal = Vector3f::UnitZ();
  }
  return normals;
}

/// Tiles of texture per metre of a triangle.
float TilesPerMetre(const std::array<Vector3f, 3>& p, const std::array<Vector2f, 3>& uv) {
  const float area = (p[1] - p[0]).cross(p[2] - p[0]).norm();
  const Vector2f u = uv[1] - uv[0];
  const Vector2f v = uv[2] - uv[0];
  const float tiles = std::abs(u.x() * v.y() - u.y() * v.x());
  return std::sqrt(tiles / std::max(area, 1e-9F));
}

void AddMesh(const SourceMesh& source, const Eigen::Vector3f& colour, const ImportOptions& options,
             Mesh* mesh) {
  const auto turn = [&](const Vector3f& v) -> Vector3f {
    return options.up == UpAxis::kY ? Vector3f(v.x(), -v.z(), v.y()) : v;
  };
  std::vector<Vector3f> positions;
  for (const Vector3f& p : source.positions)
    positions.push_back(static_cast<float>(options.scale) * turn(p));
  std::vector<Vector3f> normals;
  if (source.normals.size() == positions.size()) {
    for (const Vector3f& normal : source.normals) normals.push_back(turn(normal));
  } else {
    normals = SmoothNormals(positions, source.triangles);
  }
  const bool has_uv = source.texture_coordinates.size() == positions.size();
  const auto uv_of = [&](uint32_t i) -> Vector2f {
    return has_uv ? source.texture_coordinates[i] : Vector2f::Zero();
  };
  const auto first = static_cast<uint32_t>(mesh->vertices.size());
  const auto tint = EncodeTint({colour.x(), colour.y(), colour.z(), 1});
  for (uint32_t i = 0; i < positions.size(); ++i) {
    Vertex vertex;
    vertex.u = uv_of(i).x();
    vertex.v = uv_of(i).y();
    vertex.normal = (normals[i] * 127).array().round().cast<int8_t>();
    vertex.tint = tint;
    mesh->positions.push_back(positions[i]);
    mesh->vertices.push_back(vertex);
  }
  for (const auto& [a, b, c] : source.triangles) {
    ORB360_CHECK(std::max({a, b, c}) < positions.size(), source.name);
    mesh->triangles.push_back({{first + a, first + b, first + c},
                               static_cast<MaterialId>(source.material),
                               TilesPerMetre({positions[a], positions[b], positions[c]},
                                             {uv_of(a), uv_of(b), uv_of(c)})});
  }
}

}  // namespace

SourceScene ReadMeshFile(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw UserError(path.string() + ": no such file");
  const std::string extension = LowerExtension(path);
  SourceScene scene =
      extension == ".ac" || extension == ".acc" ? ReadAc3d(path) : ReadWithAssimp(path);
  const bool has_triangles = std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                         [](const SourceMesh& m) { return !m.triangles.empty(); });
  if (!has_triangles) throw UserError(path.string() + ": holds no triangle");
  return scene;
}

Scenery MakeScenery(const SourceScene& source, const std::filesystem::path& folder,
                    const ImportOptions& options, std::vector<std::string>* missing) {
  Scenery scenery;
  AddMaterials(source, folder, missing, &scenery.palette);
  for (const SourceMesh& mesh : source.meshes)
    AddMesh(mesh, source.materials[mesh.material].colour, options, &scenery.fixed);
  scenery.fixed.PartitionCutouts(scenery.palette);
  return scenery;
}

}  // namespace orb360::town
