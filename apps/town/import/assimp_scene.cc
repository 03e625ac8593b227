#include "apps/town/import/assimp_scene.h"

#include <algorithm>
#include <string_view>

#include <assimp/GltfMaterial.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <opencv2/imgcodecs.hpp>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

Eigen::Vector3f ToEigen(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// Decodes an image inside the file; empty if it cannot be read.
cv::Mat ToImage(const aiTexture& texture) {
  if (texture.mHeight == 0) {  // as an image file of mWidth bytes
    return cv::imdecode(cv::Mat(1, static_cast<int>(texture.mWidth), CV_8U, texture.pcData),
                        cv::IMREAD_UNCHANGED);
  }
  return cv::Mat(static_cast<int>(texture.mHeight), static_cast<int>(texture.mWidth), CV_8UC4,
                 texture.pcData)
      .clone();
}

SourceMaterial ToMaterial(const aiScene& scene, const aiMaterial& material) {
  SourceMaterial result;
  aiColor3D colour;
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS)
    result.colour = {colour.r, colour.g, colour.b};
  aiString texture;
  // glTF's base colour has priority over what older formats call the diffuse texture.
  if (material.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) == aiReturn_SUCCESS ||
      material.GetTexture(aiTextureType_DIFFUSE, 0, &texture) == aiReturn_SUCCESS)
    result.texture = texture.C_Str();
  if (result.texture.empty()) return result;
  if (const aiTexture* inside = scene.GetEmbeddedTexture(texture.C_Str()))
    result.image = ToImage(*inside);
  aiString mode;
  result.is_opaque = material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS &&
                     std::string_view(mode.C_Str()) == "OPAQUE";
  // Some programs write a black colour beside a texture.
  if (result.colour.isZero()) result.colour.setOnes();
  return result;
}

SourceMesh ToMesh(const aiMesh& mesh) {
  SourceMesh result;
  result.name = mesh.mName.C_Str();
  result.material = mesh.mMaterialIndex;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    result.positions.push_back(ToEigen(mesh.mVertices[i]));
    if (mesh.HasNormals()) result.normals.push_back(ToEigen(mesh.mNormals[i]).stableNormalized());
    if (mesh.HasTextureCoords(0))
      result.texture_coordinates.emplace_back(mesh.mTextureCoords[0][i].x,
                                              mesh.mTextureCoords[0][i].y);
    if (mesh.HasVertexColors(0)) {
      const aiColor4D& colour = mesh.mColors[0][i];
      result.colours.emplace_back(colour.r, colour.g, colour.b);
    }
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices == 3)
      result.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
  }
  return result;
}

}  // namespace

SourceScene ReadWithAssimp(const std::filesystem::path& path) {
  Assimp::Importer importer;
  constexpr float kCrease = 60;  // degrees; where faces meet at more, generated normals part
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kCrease);
  const aiScene* scene = importer.ReadFile(
      path.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices |
                         aiProcess_SortByPType | aiProcess_GenSmoothNormals |
                         aiProcess_JoinIdenticalVertices | aiProcess_TransformUVCoords);
  if (scene == nullptr) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw UserError(path.string() + ": " + reason);
  }
  SourceScene result;
  for (unsigned i = 0; i < scene->mNumMaterials; ++i)
    result.materials.push_back(ToMaterial(*scene, *scene->mMaterials[i]));
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    result.meshes.push_back(ToMesh(*scene->mMeshes[i]));
  return result;
}

}  // namespace orb360::town
