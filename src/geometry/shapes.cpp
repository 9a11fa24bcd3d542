#include "geometry/shapes.h"

#include "geometry/io/msh.h"
#include "geometry/io/read.h"
#include "geometry/io/text.h"
#include "geometry/primitives.h"
#include "geometry/tetrahedralise.h"
#include "geometry/topology.h"
#include "geometry/topology_check.h"

namespace mortise::geometry {
namespace {

// Runs `make` and gives errors without a place the place of the block.
template <class Make>
auto located(const SourceLoc& at, const Make& make) {
  try {
    return make();
  } catch (const Error& e) {
    if (e.located()) throw;
    throw Error(e.code(), at, e.what());
  }
}

TetMesh primitive(const std::string& kind, const Params& p) {
  const double h = p.number("edge_length");
  if (kind == "box") return box(p.vec3("size"), h);
  if (kind == "sphere") return sphere(p.number("radius"), h);
  if (kind == "cylinder") return cylinder(p.number("radius"), p.number("height"), h);
  if (kind == "capsule") return capsule(p.number("radius"), p.number("height"), h);
  throw Error(Exit::scene, p.where(), "unknown shape '" + kind + "'");
}

const std::pair<std::string, Params>& only_entry(const Params& shape) {
  if (shape.entries().size() != 1)
    throw Error(Exit::scene, shape.where(), "a shape is exactly one of box, sphere, cylinder, capsule, mesh");
  return shape.entries().front();
}

std::string named(const Params& p) { return "mesh '" + p.text("file") + "'"; }

void scale(std::vector<Vec3>& points, double factor) {
  for (Vec3& p : points) p *= factor;
}

TriMesh scaled_surface(const Params& p) {
  TriMesh mesh = read_surface(p.text("file"));
  scale(mesh.points, p.number("scale"));
  return p.number("weld") > 0 ? weld(mesh, p.number("weld")) : mesh;  // the tolerance is in metres, so after scaling
}

bool has_tets(const std::string& file) { return extension(file) == ".msh" && !read_msh(file).tets.empty(); }

}  // namespace

TetMesh tet_shape(const Params& shape) {
  const auto& [kind, p] = only_entry(shape);
  return located(p.where(), [&, kind = kind, &p = p] {
    if (kind != "mesh") return primitive(kind, p);
    if (has_tets(p.text("file"))) {
      TetMesh mesh = read_tets(p.text("file"));
      scale(mesh.points, p.number("scale"));
      check_tets(mesh, named(p));
      return mesh;
    }
    if (!p.has("edge_length"))
      throw Error(Exit::scene, named(p) + " is a surface: a soft body needs edge_length to fill it with tetrahedra");
    TetrahedraliseOptions options;
    options.edge_length = p.number("edge_length");
    if (p.has("surface_edge_length")) options.surface_edge_length = p.number("surface_edge_length");
    return tetrahedralise(scaled_surface(p), options, named(p));
  });
}

TriMesh surface_shape(const Params& shape) {
  const auto& [kind, p] = only_entry(shape);
  return located(p.where(), [&, kind = kind, &p = p] {
    if (kind != "mesh") return surface_of(primitive(kind, p));
    TriMesh mesh = scaled_surface(p);
    check_closed_surface(mesh, named(p));
    return mesh;
  });
}

}  // namespace mortise::geometry
