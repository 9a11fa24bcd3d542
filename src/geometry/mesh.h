#pragma once
// Host meshes, in metres and double precision. What the readers and generators make; the device never sees these.
#include <cstdint>
#include <string>
#include <vector>

#include "base/types.h"

namespace mortise::geometry {

// Triangle surface. Triangles of a closed surface are ordered counter-clockwise seen from outside.
struct TriMesh {
  std::vector<Vec3> points;  // [m]
  std::vector<Triangle> triangles;
};

// The nodes in the middle of the edges of a quadratic tetrahedron, in the order of geometry/quadratic.h.
struct Midsides {
  Index v[6];
};
// Quadratic triangle: three corners, then the middles of (0,1), (1,2), (2,0).
struct Face {
  Index v[6];
};

// Tetrahedra (a,b,c,d) with det(b-a, c-a, d-a) > 0.
struct TetMesh {
  std::vector<Vec3> points;  // [m]
  std::vector<Tet> tets;
  std::vector<Midsides> midsides{};  // one per tetrahedron, or none: linear tetrahedra
  bool quadratic() const { return !midsides.empty(); }
};

// A picture: a file, or the bytes of a PNG/JPEG file that was embedded in the mesh. Both empty: no texture.
struct Texture {
  std::string file;
  std::vector<std::uint8_t> bytes;
  bool empty() const { return file.empty() && bytes.empty(); }
};

struct VisualMaterial {
  std::string name;
  Vec3 base_color{0.8, 0.8, 0.8};  // multiplied with the texture where there is one
  double roughness = 0.5;          // 0 mirror .. 1 matt
  double metallic = 0;
  Texture texture;
};

// What is drawn. Vertices are split where normals or texture coordinates jump, so `points` repeats positions.
struct VisualMesh {
  std::vector<Vec3> points;   // [m]
  std::vector<Vec3> normals;  // unit, one per point
  std::vector<Vec2> uvs;      // one per point, (0,0) = lower left corner of the picture; zero where the file has none
  std::vector<Triangle> triangles;
  std::vector<Index> part;      // per triangle: mesh (object) of the file
  std::vector<Index> material;  // per triangle: into `materials`
  std::vector<VisualMaterial> materials;
  bool has_uvs = false;
};

}  // namespace mortise::geometry
