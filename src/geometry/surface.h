#pragma once
// What contact sees of all bodies: points with positions y (m), and the triangles, edges and vertices among them that collide.
// Point ids run over *all* points of the model (soft nodes and vertices of stiff bodies, body after body); primitives refer to
// them. How y depends on the degrees of freedom is not this layer's business (model/model.h).
#include "geometry/body_pairs.h"

namespace mortise::geometry {

struct SurfaceView {
  device::View<const Index> vertices;             // point ids that collide as points
  device::View<const Edge> edges;                 // unique edges, v[0] < v[1]
  device::View<const Triangle> triangles;         // outward orientation
  device::View<const Index> body;                 // per point: body
  device::View<const Index> env;                  // per point: environment
  device::View<const double> vertex_area;         // per point [m^2]: a third of the rest areas of its triangles (0 inside bodies)
  device::View<const double> edge_area;           // per edge [m^2]: a third of the rest areas of its triangles
  BodyPairsView pairs;                            // where tables keep what holds of two bodies
  device::View<const std::uint8_t> pair_allowed;  // per pair of bodies: 1 where contact between them is watched

  MORTISE_HD bool watched(Index point_a, Index point_b) const {
    return env[point_a] == env[point_b] && pair_allowed[pairs.of(body[point_a], body[point_b])] != 0;
  }
};

struct Surface {
  device::Buffer<Index> vertices, body, env;
  device::Buffer<Edge> edges;
  device::Buffer<Triangle> triangles;
  device::Buffer<double> vertex_area, edge_area;
  BodyPairs pairs;
  device::Buffer<std::uint8_t> pair_allowed;

  SurfaceView view() const {
    return {vertices.view(),    edges.view(),     triangles.view(), body.view(),        env.view(),
            vertex_area.view(), edge_area.view(), pairs.view(),     pair_allowed.view()};
  }
};

}  // namespace mortise::geometry
