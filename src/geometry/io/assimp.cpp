#include "geometry/io/assimp.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <filesystem>

#include "base/child.h"
#include "base/error.h"
#include "geometry/io/corners.h"
#include "geometry/io/text.h"
#include "geometry/io/visual_bytes.h"

namespace mortise::geometry {
namespace {

Vec3 vec(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Eigen::Matrix4d matrix(const aiMatrix4x4& m) {
  Eigen::Matrix4d out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out(i, j) = m[i][j];
  return out;
}

Texture texture(const std::string& path, const aiScene& scene, const aiMaterial& material) {
  aiString name;
  if (material.GetTexture(aiTextureType_BASE_COLOR, 0, &name) != aiReturn_SUCCESS &&
      material.GetTexture(aiTextureType_DIFFUSE, 0, &name) != aiReturn_SUCCESS)
    return {};
  Texture out;
  if (const aiTexture* embedded = scene.GetEmbeddedTexture(name.C_Str())) {
    if (embedded->mHeight != 0) throw Error(Exit::scene, "'" + path + "': uncompressed embedded textures are not supported");
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(embedded->pcData);
    out.bytes.assign(bytes, bytes + embedded->mWidth);  // mHeight 0: mWidth counts bytes
  } else {
    out.file = (std::filesystem::path(path).parent_path() / name.C_Str()).lexically_normal().string();
  }
  return out;
}

VisualMaterial material(const std::string& path, const aiScene& scene, const aiMaterial& in) {
  VisualMaterial out;
  out.name = in.GetName().C_Str();
  aiColor4D color;
  if (in.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS || in.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS)
    out.base_color = {color.r, color.g, color.b};
  float value;
  if (in.Get(AI_MATKEY_ROUGHNESS_FACTOR, value) == aiReturn_SUCCESS) out.roughness = value;
  if (in.Get(AI_MATKEY_METALLIC_FACTOR, value) == aiReturn_SUCCESS) out.metallic = value;
  out.texture = texture(path, scene, in);
  return out;
}

class Collector {
 public:
  Collector(const std::string& path, const aiScene& scene) : path_(path), scene_(scene), out_(path) {}

  // Depth first: every mesh of every node, in world position.
  void visit(const aiNode& node, const Eigen::Matrix4d& parent) {
    const Eigen::Matrix4d here = parent * matrix(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene_.mMeshes[node.mMeshes[i]], here);
    for (unsigned i = 0; i < node.mNumChildren; ++i) visit(*node.mChildren[i], here);
  }

  VisualMesh finish() {
    std::vector<VisualMaterial> materials;
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i) materials.push_back(material(path_, scene_, *scene_.mMaterials[i]));
    return out_.finish(std::move(materials), has_uvs_);
  }

 private:
  void add(const aiMesh& mesh, const Eigen::Matrix4d& m) {
    if (!(mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) return;
    const Mat3 linear = m.topLeftCorner<3, 3>();
    const double det = linear.determinant();
    // Normals turn with the cofactor matrix det(A) A^-T; a mirror (det < 0) also exchanges the sides of triangles.
    Mat3 cofactor;
    for (int c = 0; c < 3; ++c) cofactor.col(c) = linear.col((c + 1) % 3).cross(linear.col((c + 2) % 3));
    if (det < 0) cofactor = -cofactor;

    const bool uvs = mesh.HasTextureCoords(0);
    has_uvs_ = has_uvs_ || uvs;
    std::vector<Index> vertex(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const Vec3 p = linear * vec(mesh.mVertices[i]) + m.topRightCorner<3, 1>();
      const Vec3 n = mesh.HasNormals() ? Vec3(cofactor * vec(mesh.mNormals[i])) : Vec3(0, 0, 0);
      const Vec2 t = uvs ? Vec2(mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y) : Vec2(0, 0);
      vertex[i] = out_.vertex(part_, p, n, t);
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& f = mesh.mFaces[i];
      if (f.mNumIndices != 3) continue;  // points and lines
      Triangle t;
      for (int k = 0; k < 3; ++k) {
        if (f.mIndices[k] >= mesh.mNumVertices)
          throw Error(Exit::scene, "'" + path_ + "': triangle " + std::to_string(i) + " names a vertex that is not there");
        t.v[k] = vertex[f.mIndices[k]];
      }
      if (det < 0) std::swap(t.v[1], t.v[2]);
      out_.triangle(part_, static_cast<Index>(mesh.mMaterialIndex), t);
    }
    ++part_;
  }

  const std::string& path_;
  const aiScene& scene_;
  CornerCollector out_;
  Index part_ = 0;
  bool has_uvs_ = false;
};

VisualMesh read_here(const std::string& path) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) throw Error(Exit::scene, "'" + path + "' cannot be read as " + extension(path) + ": " + importer.GetErrorString());
  Collector collector(path, *scene);
  collector.visit(*scene->mRootNode, Eigen::Matrix4d::Identity());
  return collector.finish();
}

}  // namespace

VisualMesh read_with_assimp(const std::string& path) {
  const std::size_t size = read_file(path).size();  // a missing file is Exit::file; assimp would not tell it from a broken one
  // Damaged files crash assimp. The limits are many times what a sound file needs.
  const ChildLimits limits{60 + static_cast<unsigned>(size >> 20), (std::size_t{4} << 30) + 100 * size};
  const std::string bytes = in_child("'" + path + "' cannot be read as " + extension(path), limits, [&] { return to_bytes(read_here(path)); });
  return visual_from_bytes(path, bytes);
}

}  // namespace mortise::geometry
