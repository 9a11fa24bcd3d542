#include "geometry/shapes.h"

#include <algorithm>
#include <cmath>

#include "geometry/io/msh.h"
#include "geometry/io/read.h"
#include "geometry/io/text.h"
#include "geometry/midsides.h"
#include "geometry/placement.h"
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

Grid primitive(const std::string& kind, const Params& p, Index single = 1) {
  const double h = p.number("edge_length");
  if (kind == "box") return box_grid(p.vec3("size"), h, single);
  if (kind == "sphere") return sphere_grid(p.number("radius"), h);
  if (kind == "cylinder") return cylinder_grid(p.number("radius"), p.number("height"), h);
  if (kind == "capsule") return capsule_grid(p.number("radius"), p.number("height"), h);
  throw Error(Exit::scene, p.where(), "unknown shape '" + kind + "'");
}

const std::pair<std::string, Params>& only_entry(const Params& shape) {
  if (shape.entries().size() != 1) throw Error(Exit::scene, shape.where(), "a shape is exactly one of box, sphere, cylinder, capsule, mesh, parts");
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

// Onto the exact surface: R away from the axis of a cylinder or capsule (a point for a sphere).
Snap surface_snap(const std::string& kind, const Params& p) {
  if (kind != "sphere" && kind != "cylinder" && kind != "capsule")
    throw Error(Exit::scene, "curved edges need a sphere, cylinder or capsule (a mesh of second order brings its own)");
  const double R = p.number("radius"), half = kind == "sphere" ? 0 : 0.5 * p.number("height");
  if (kind == "cylinder")
    return [R](const Vec3& a, const Vec3& b, const Vec3& x) -> Vec3 {
      const auto on_side = [R](const Vec3& c) { return std::abs(c.head<2>().norm() - R) < 1e-9 * R; };
      if (!on_side(a) || !on_side(b)) return x;  // an edge of the flat ends
      const double s = R / x.head<2>().norm();
      return {s * x[0], s * x[1], x[2]};
    };
  return [R, half](const Vec3&, const Vec3&, const Vec3& x) -> Vec3 {
    const Vec3 axis(0, 0, std::clamp(x[2], -half, half));
    return axis + R * (x - axis).normalized();
  };
}

bool has_tets(const std::string& file) { return extension(file) == ".msh" && !read_msh(file).tets.empty(); }

TetMesh mesh_tets(const Params& p) {
  if (has_tets(p.text("file"))) {
    TetMesh mesh = read_tets(p.text("file"));
    scale(mesh.points, p.number("scale"));
    check_tets(mesh, named(p));
    return mesh;
  }
  const TriMesh surface = scaled_surface(p);  // what is wrong with it is said first
  if (!p.has("edge_length")) throw Error(Exit::scene, named(p) + " is a surface: a soft body needs edge_length to fill it with tetrahedra");
  TetrahedraliseOptions options;
  options.edge_length = p.number("edge_length");
  if (p.has("surface_edge_length")) options.surface_edge_length = p.number("surface_edge_length");
  return tetrahedralise(surface, options, named(p));
}

// Side by side or one in the other: parts of a stiff body never move against each other, so their surfaces may cross.
TriMesh all_parts(const Params& list, Index single) {
  TriMesh all;
  for (const Params& part : list.items()) {
    TriMesh mesh = surface_shape(part.at("shape"), single);
    Placement(part).apply(mesh.points);
    append(mesh, all);
  }
  return all;
}

}  // namespace

TetMesh tet_shape(const Params& shape, const ElementOrder& element) {
  const auto& [kind, p] = only_entry(shape);
  return located(p.where(), [&, kind = kind, &p = p] {
    if (element.curved && element.order == 1) throw Error(Exit::scene, "curved edges need `order: 2`");
    if (kind == "parts") throw Error(Exit::scene, "'parts' are for stiff bodies: a soft body is of one piece");
    const Snap snap = element.curved ? surface_snap(kind, p) : Snap{};
    TetMesh mesh = kind == "mesh" ? mesh_tets(p) : solid(primitive(kind, p));
    if (mesh.quadratic() && element.order == 1) throw Error(Exit::scene, named(p) + " has tetrahedra of second order: give the body `order: 2`");
    return element.order == 1 || mesh.quadratic() ? mesh : with_midsides(std::move(mesh), snap);
  });
}

std::optional<TriMesh> remeshed_surface(const Params& shape) {
  const auto& [kind, p] = only_entry(shape);
  if (kind != "mesh" || !p.has("edge_length") || has_tets(p.text("file"))) return {};
  return scaled_surface(p);
}

TriMesh surface_shape(const Params& shape, Index single) {
  const auto& [kind, p] = only_entry(shape);
  if (kind == "parts") return all_parts(p, single);
  return located(p.where(), [&, kind = kind, &p = p] {
    if (kind != "mesh") return skin(primitive(kind, p, single));
    TriMesh mesh = scaled_surface(p);
    check_closed_surface(mesh, named(p));
    return mesh;
  });
}

}  // namespace mortise::geometry
