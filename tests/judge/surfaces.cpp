#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include "judge/judge.h"

namespace judge {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

}  // namespace

void judge_surfaces(const Case& c, const std::vector<Vector>& x, long frame, Verdict& v) {
  Surface surface;
  std::vector<std::pair<const Body*, long>> owner;
  std::map<long, Surface::Vertex_index> vertex;
  const auto at = [&](long p) {
    const auto [it, fresh] = vertex.try_emplace(p);
    if (fresh) it->second = surface.add_vertex({x[p][0], x[p][1], x[p][2]});
    return it->second;
  };
  for (const Body& body : c.bodies)
    for (std::size_t t = 0; t < body.triangles.size(); ++t) {
      const auto& f = body.triangles[t];
      if (surface.add_face(at(f[0]), at(f[1]), at(f[2])) == Surface::null_face()) {  // not manifold here: with vertices of its own
        std::array<Surface::Vertex_index, 3> own;
        for (int k = 0; k < 3; ++k) own[k] = surface.add_vertex({x[f[k]][0], x[f[k]][1], x[f[k]][2]});
        surface.add_face(own[0], own[1], own[2]);
      }
      owner.emplace_back(&body, static_cast<long>(t));
    }
  std::vector<std::pair<Surface::Face_index, Surface::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections<CGAL::Sequential_tag>(surface, std::back_inserter(pairs));
  for (const auto& [f, g] : pairs) {
    const auto& [a, i] = owner.at(f.idx());
    const auto& [b, j] = owner.at(g.idx());
    if (!c.apart(*a, b, b->name)) continue;
    ++v.intersections;
    v.found(frame, "triangle " + std::to_string(i) + " of " + a->name + " meets triangle " + std::to_string(j) + " of " + b->name);
  }
  for (const Plane& plane : c.planes)
    for (const Body& body : c.bodies) {
      if (!c.apart(body, nullptr, plane.name)) continue;
      std::set<long> outside;  // nodes inside of an inverted element may be anywhere
      for (const auto& t : body.triangles) outside.insert(t.begin(), t.end());
      for (long p : outside)
        if (!(dot(x[p] - plane.point, plane.normal) > 0)) ++v.below, v.found(frame, "a vertex of " + body.name + " is on or below " + plane.name);
    }
}

}  // namespace judge
