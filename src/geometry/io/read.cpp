#include "geometry/io/read.h"

#include "geometry/io/assimp.h"
#include "geometry/io/msh.h"
#include "geometry/io/obj.h"
#include "geometry/io/ply.h"
#include "geometry/io/stl.h"
#include "geometry/io/text.h"
#include "geometry/topology.h"

namespace mortise::geometry {
namespace {

bool for_assimp(const std::string& e) { return e == ".glb" || e == ".gltf" || e == ".dae"; }

[[noreturn]] void unknown(const std::string& path, const char* supported) {
  throw Error(Exit::scene, "'" + path + "': mesh format '" + extension(path) + "' is not supported here (" + supported + ")");
}

}  // namespace

TriMesh read_surface(const std::string& path, double weld_tolerance) {
  const std::string e = extension(path);
  TriMesh mesh;
  if (e == ".obj") {
    mesh = surface_from(parse_obj(path, read_file(path), false));
  } else if (e == ".msh") {
    MshFile msh = read_msh(path);
    if (!msh.tets.empty()) return surface_of(read_tets(path));
    mesh.points = std::move(msh.points), mesh.triangles = std::move(msh.triangles);
  } else if (e == ".stl") {
    mesh = surface_from(parse_stl(path, read_file(path)));
  } else if (e == ".ply") {
    mesh = surface_from(parse_ply(path, read_file(path)));
  } else if (for_assimp(e)) {
    const VisualMesh visual = read_with_assimp(path);
    mesh.points = visual.points, mesh.triangles = visual.triangles;
  } else {
    unknown(path, ".obj .stl .ply .glb .gltf .dae .msh");
  }
  if (mesh.triangles.empty()) throw Error(Exit::scene, "'" + path + "' has no triangles");
  return weld(mesh, weld_tolerance);
}

VisualMesh read_visual(const std::string& path) {
  const std::string e = extension(path);
  VisualMesh mesh;
  if (e == ".obj") {
    mesh = visual_from(read_obj(path));
  } else if (e == ".stl") {
    mesh = visual_from(path, parse_stl(path, read_file(path)));
  } else if (e == ".ply") {
    mesh = visual_from(path, parse_ply(path, read_file(path)));
  } else if (for_assimp(e)) {
    mesh = read_with_assimp(path);
  } else {
    unknown(path, ".obj .stl .ply .glb .gltf .dae");
  }
  if (mesh.triangles.empty()) throw Error(Exit::scene, "'" + path + "' has no triangles");
  return mesh;
}

TetMesh read_tets(const std::string& path) {
  if (extension(path) != ".msh") unknown(path, ".msh");
  MshFile msh = read_msh(path);
  if (msh.tets.empty()) throw Error(Exit::scene, "'" + path + "' has no tetrahedra");
  TetMesh mesh = without_unused_points(TetMesh{std::move(msh.points), std::move(msh.tets), std::move(msh.midsides)});
  bool all_negative = true;
  for (const Tet& t : mesh.tets) all_negative = all_negative && tet_volume(mesh.points, t) < 0;
  if (!all_negative) return mesh;
  for (Tet& t : mesh.tets) std::swap(t.v[0], t.v[1]);
  for (Midsides& m : mesh.midsides) std::swap(m.v[1], m.v[2]), std::swap(m.v[3], m.v[4]);  // (1,2) <-> (0,2), (0,3) <-> (1,3)
  return mesh;
}

}  // namespace mortise::geometry
