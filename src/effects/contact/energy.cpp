#include "effects/contact/active.h"
#include "effects/contact/select.h"

namespace mortise::effects::contact {
namespace {

// The pairs in range. Energies are sums over them only, so that the order of the sum is a function of y, not of how many more
// candidates are held.
struct InRange {
  Buffer<Index> at;           // offsets among them by candidate
  std::vector<Index> bounds;  // of the environments
};

template <class Pair>
void find(const BarrierView& s, View<const Pair> pairs, const std::vector<Index>& env_offset, const device::Ranges& whose, View<const Vec3> y,
          InRange& out, device::Fetch& fetch) {
  mark(
      "contact.near", pairs.n, whose, [=] MORTISE_HD(Index i) { return near(s, pairs[i], y); }, out.at);
  const View<const Index> at = std::as_const(out.at).view();
  out.bounds.assign(env_offset.size(), 0);
  if (out.bounds.size() == 2) return fetch.add_total(out.at, out.bounds[1]);
  const Buffer<Index> offset(env_offset);
  Buffer<Index> bounds(offset.size());
  const View<const Index> from = offset.view();
  const View<Index> bound = bounds.view();
  device::parallel_for("contact.env_offset", from.n, [=] MORTISE_HD(Index e) { bound[e] = at[from[e]]; });
  fetch.add(View<const Index>(bound), out.bounds);
  fetch.keep(std::move(bounds));
}

template <class Pair>
void add_pair_energy(const char* name, const BarrierView& s, View<const Pair> pairs, const InRange& near, View<const Vec3> y,
                     device::EnvValues per_env) {
  if (near.bounds.back() == 0) return;
  Buffer<Index> picked(near.bounds.back());
  const View<const Index> at = near.at.view();
  const View<Index> list = picked.view();
  device::parallel_for("contact.pick", pairs.n, [=] MORTISE_HD(Index i) {
    if (at[i + 1] > at[i]) list[at[i]] = i;
  });
  device::env_sum(
      name, near.bounds, [=] MORTISE_HD(Index i) { return pair_energy(s, pairs[list[i]], y); }, per_env);
}

}  // namespace

void energy(const BarrierView& s, const Candidates& c, View<const Vec3> y, const device::Ranges& vertices, device::EnvValues per_env) {
  InRange points, edges;
  device::Fetch fetch;
  find(s, c.point_triangles(), c.pt_env_offset(), c.of_points(), y, points, fetch);
  find(s, c.edge_edges(), c.ee_env_offset(), c.of_edges(), y, edges, fetch);
  fetch.now();
  add_pair_energy("contact.energy_points", s, c.point_triangles(), points, y, per_env);
  add_pair_energy("contact.energy_edges", s, c.edge_edges(), edges, y, per_env);
  for (Index p = 0; p < s.planes.n; ++p) {
    const Index first = p * s.surface.vertices.n;
    device::env_sum(
        "contact.energy_planes", vertices, [=] MORTISE_HD(Index i) { return plane_energy(s, first + i, y); }, per_env);
  }
}

void limit_planes(const BarrierView& s, View<const Vec3> y, View<const Vec3> dy, double keep, const device::Ranges& vertices,
                  device::EnvValues alpha) {
  for (Index p = 0; p < s.planes.n; ++p)
    device::env_min(
        "contact.limit_planes", vertices,
        [=] MORTISE_HD(Index i) {
          const Index point = s.surface.vertices[i];
          if (!s.sees_plane(point, p)) return 2.0;
          const double gap = s.planes[p].normal.dot(y[point] - s.planes[p].point), rate = -s.planes[p].normal.dot(dy[point]);
          if (!(rate > 0)) return 2.0;
          return gap > 0 ? (1 - keep) * gap / rate : 0.0;
        },
        alpha);
}

std::vector<double> least_distances(const BarrierView& s, const Candidates& c, View<const Vec3> y, const std::vector<Index>& vertex_env) {
  const View<const PointTriangle> points = c.point_triangles();
  const View<const EdgeEdge> edges = c.edge_edges();
  const std::size_t envs = vertex_env.size() - 1;
  std::vector<double> squared(envs, INFINITY), gap(envs, INFINITY);
  device::Fetch fetch;
  device::env_min(
      "contact.nearest_points", c.pt_env_offset(),
      [=] MORTISE_HD(Index i) {
        const Index* v = points[i].v;
        if (!s.sees(v[0], v[1])) return static_cast<double>(INFINITY);
        Vec3 x[4];
        gather(y, v, x);
        const double D = geometry::closest_point_triangle(x).squared;
        return s.surface.body[v[0]] == s.surface.body[v[1]] && D > s.self_range[v[0]] * s.self_range[v[0]] ? static_cast<double>(INFINITY) : D;
      },
      device::EnvValues{squared, fetch});
  device::env_min(
      "contact.nearest_edges", c.ee_env_offset(),
      [=] MORTISE_HD(Index i) {
        const Index* v = edges[i].v;
        if (!s.sees(v[0], v[2])) return static_cast<double>(INFINITY);
        Vec3 x[4];
        gather(y, v, x);
        const double D = geometry::closest_edge_edge(x).squared, range = edge_range(s, v);
        return s.surface.body[v[0]] == s.surface.body[v[2]] && D > range * range ? static_cast<double>(INFINITY) : D;
      },
      device::EnvValues{squared, fetch});
  for (Index plane = 0; plane < s.planes.n; ++plane)
    device::env_min(
        "contact.nearest_planes", vertex_env,
        [=] MORTISE_HD(Index i) {
          const Index p = s.surface.vertices[i];
          if (!s.sees_plane(p, plane)) return static_cast<double>(INFINITY);
          return s.planes[plane].normal.dot(y[p] - s.planes[plane].point);
        },
        device::EnvValues{gap, fetch});
  fetch.now();
  for (std::size_t e = 0; e < envs; ++e) gap[e] = std::fmin(gap[e], std::sqrt(squared[e]));
  return gap;
}

}  // namespace mortise::effects::contact
