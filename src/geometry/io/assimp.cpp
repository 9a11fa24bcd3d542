#include "geometry/io/assimp.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <array>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <map>

#include "base/error.h"
#include "geometry/io/normals.h"
#include "geometry/io/text.h"

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
  Collector(std::string path, const aiScene& scene) : path_(std::move(path)), scene_(scene) {}

  // Depth first: every mesh of every node, in world position.
  void visit(const aiNode& node, const Eigen::Matrix4d& parent) {
    const Eigen::Matrix4d here = parent * matrix(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene_.mMeshes[node.mMeshes[i]], here);
    for (unsigned i = 0; i < node.mNumChildren; ++i) visit(*node.mChildren[i], here);
  }

  VisualMesh finish() {
    complete_normals(out_, position_, has_normal_);
    return std::move(out_);
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
    out_.has_uvs = out_.has_uvs || uvs;
    std::vector<Index> vertex(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const Vec3 p = linear * vec(mesh.mVertices[i]) + m.topRightCorner<3, 1>();
      const Vec3 n = mesh.HasNormals() ? Vec3(cofactor * vec(mesh.mNormals[i])) : Vec3(0, 0, 0);
      const Vec2 t = uvs ? Vec2(mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y) : Vec2(0, 0);
      if (!p.allFinite())
        throw Error(Exit::scene, "'" + path_ + "': coordinate of vertex " + std::to_string(i) + " is not a finite number");
      vertex[i] = add_vertex(p, n, t, mesh.HasNormals());
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& f = mesh.mFaces[i];
      if (f.mNumIndices != 3) continue;  // points and lines
      Triangle t{{vertex[f.mIndices[0]], vertex[f.mIndices[1]], vertex[f.mIndices[2]]}};
      if (det < 0) std::swap(t.v[1], t.v[2]);
      out_.triangles.push_back(t);
      out_.part.push_back(part_);
      out_.material.push_back(static_cast<Index>(mesh.mMaterialIndex));
    }
    ++part_;
  }

  Index add_vertex(const Vec3& p, const Vec3& n, const Vec2& t, bool has_normal) {
    const Index place = positions_.try_emplace({p[0], p[1], p[2]}, static_cast<Index>(positions_.size())).first->second;
    const auto [at, fresh] = vertices_.try_emplace({double(part_), double(place), n[0], n[1], n[2], t[0], t[1]},
                                                   static_cast<Index>(out_.points.size()));
    if (fresh) {
      out_.points.push_back(p), out_.normals.push_back(n), out_.uvs.push_back(t);
      position_.push_back(place), has_normal_.push_back(has_normal);
    }
    return at->second;
  }

  std::string path_;
  const aiScene& scene_;
  VisualMesh out_;
  Index part_ = 0;
  std::map<std::array<double, 3>, Index> positions_;
  std::map<std::array<double, 7>, Index> vertices_;
  std::vector<Index> position_;
  std::vector<char> has_normal_;
};

}  // namespace

VisualMesh read_with_assimp(const std::string& path) {
  read_file(path);  // a missing file is Exit::file; assimp would not tell it from a broken one
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode)
    throw Error(Exit::scene, "'" + path + "' cannot be read as " + extension(path) + ": " + importer.GetErrorString());
  Collector collector(path, *scene);
  collector.visit(*scene->mRootNode, Eigen::Matrix4d::Identity());
  VisualMesh mesh = collector.finish();
  for (unsigned i = 0; i < scene->mNumMaterials; ++i) mesh.materials.push_back(material(path, *scene, *scene->mMaterials[i]));
  return mesh;
}

}  // namespace mortise::geometry
