#pragma once
// What contact effects see besides deforming bodies, and who is whose neighbour on their surfaces.
#include "geometry/surface.h"

namespace mortise::effects::contact {

using device::Buffer;
using device::View;

// Surface of a half-space; the normal points out of the solid.
struct Plane {
  Vec3 point, normal;
};

// Who is whose neighbour on the surface; constant.
struct TopologyView {
  View<const Index> triangle_edge;                 // 3 per triangle: edges of corners (0,1), (1,2), (2,0)
  View<const Index> edge_offset, edge_triangle;    // triangles of every edge
  View<const Index> point_offset, point_triangle;  // triangles of every point
  View<const Index> point_edges;                   // number of edges at every point
};
struct Topology {
  Buffer<Index> triangle_edge, edge_offset, edge_triangle, point_offset, point_triangle, point_edges;
  Topology(const geometry::Surface& surface, Index points);
  TopologyView view() const {
    return {triangle_edge.view(), edge_offset.view(), edge_triangle.view(), point_offset.view(), point_triangle.view(), point_edges.view()};
  }
};

MORTISE_HD inline bool has(const Triangle& t, Index p) { return t.v[0] == p || t.v[1] == p || t.v[2] == p; }

}  // namespace mortise::effects::contact
