#include "geometry/io/corners.h"

#include "base/error.h"
#include "geometry/io/normals.h"

namespace mortise::geometry {

Index CornerCollector::vertex(Index part, const Vec3& p, const Vec3& normal, const Vec2& t) {
  const auto refuse = [&](const char* what) {
    throw Error(Exit::scene, "'" + path_ + "': " + what + " of vertex " + std::to_string(mesh_.points.size()) + " is not a finite number");
  };
  if (!p.allFinite()) refuse("coordinate");
  if (!t.allFinite()) refuse("texture coordinate");
  const bool given = normal.allFinite() && normal.norm() > 0;
  const Vec3 n = given ? normal : Vec3(0, 0, 0);
  const Index place = positions_.try_emplace({p[0], p[1], p[2]}, static_cast<Index>(positions_.size())).first->second;
  const auto [at, fresh] =
      vertices_.try_emplace({double(part), double(place), n[0], n[1], n[2], t[0], t[1]}, static_cast<Index>(mesh_.points.size()));
  if (fresh) {
    mesh_.points.push_back(p), mesh_.normals.push_back(n), mesh_.uvs.push_back(t);
    position_.push_back(place), has_normal_.push_back(given);
  }
  return at->second;
}

void CornerCollector::triangle(Index part, Index material, const Triangle& corners) {
  mesh_.triangles.push_back(corners);
  mesh_.part.push_back(part);
  mesh_.material.push_back(material);
}

VisualMesh CornerCollector::finish(std::vector<VisualMaterial> materials, bool has_uvs) {
  complete_normals(mesh_, position_, has_normal_);
  mesh_.materials = std::move(materials);
  mesh_.has_uvs = has_uvs;
  return std::move(mesh_);
}

}  // namespace mortise::geometry
