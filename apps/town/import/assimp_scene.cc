#include "apps/town/import/assimp_scene.h"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "slam/check.h"

namespace orb360::town {
namespace {

Eigen::Vector3f ToEigen(const aiVector3D& v) { return {v.x, v.y, v.z}; }

SourceMaterial ToMaterial(const aiMaterial& material) {
  SourceMaterial result;
  aiColor3D colour;
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS)
    result.colour = {colour.r, colour.g, colour.b};
  aiString texture;
  // glTF's base colour, then what older formats call the diffuse texture.
  if (material.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) == aiReturn_SUCCESS ||
      material.GetTexture(aiTextureType_DIFFUSE, 0, &texture) == aiReturn_SUCCESS)
    result.texture = texture.C_Str();
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
  const aiScene* scene =
      importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                           aiProcess_SortByPType);
  if (scene == nullptr) throw UserError(path.string() + ": " + importer.GetErrorString());
  SourceScene result;
  for (unsigned i = 0; i < scene->mNumMaterials; ++i)
    result.materials.push_back(ToMaterial(*scene->mMaterials[i]));
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    result.meshes.push_back(ToMesh(*scene->mMeshes[i]));
  return result;
}

}  // namespace orb360::town
