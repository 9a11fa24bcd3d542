#include <memory>
#include <utility>

#include "effects/contact/active.h"
#include "effects/contact/proximity.h"
#include "effects/contact/select.h"

namespace mortise::effects::contact {
namespace {

// Energies are sums over the pairs in range only, so that the order of the sum is a function of y, not of how many more candidates are held. Those of
// an environment stand, in order, at the front of its candidates' places, and nothing behind them adds 0: the host need not know how many they are.
template <class Pair>
void add_pair_energy(const char* name, const BarrierView& s, View<const Pair> pairs, View<const Index> first, const device::Ranges& whose,
                     View<const Vec3> y, device::EnvValues per_env) {
  Buffer<Index> offset, picked(pairs.n);
  mark(
      "contact.near", pairs.n, whose, [=] MORTISE_HD(Index i) { return near(s, pairs[i], y); }, offset);
  const View<const Index> at = std::as_const(offset).view(), env = s.surface.env;
  const View<Index> list = picked.view();
  const bool one = first.n == 2;
  device::parallel_for("contact.pick", pairs.n, [=] MORTISE_HD(Index i) {
    if (at[i + 1] == at[i]) return;
    const Index begin = one ? 0 : first[env[pairs[i].v[0]]];
    list[begin + at[i] - at[begin]] = i;
  });
  device::env_sum(
      name, whose,
      [=] MORTISE_HD(Index i) {
        const Index e = one ? 0 : env[pairs[i].v[0]], begin = one ? 0 : first[e], end = one ? pairs.n : first[e + 1];
        return i - begin < at[end] - at[begin] ? pair_energy(s, pairs[list[i]], y) : 0.0;
      },
      per_env);
}

// One after the other: of points, of edges, and towards every half-space.
struct EnergyParts {
  std::vector<std::vector<double>> of;
  Candidates::Look look;

  void find(const BarrierView& s, const Candidates& c, View<const Vec3> y, const device::Ranges& vertices, device::Fetch& fetch) {
    of.assign(2 + s.planes.n, std::vector<double>(vertices.environments(), 0.0));
    add_pair_energy("contact.energy_points", s, c.point_triangles(), c.pt_env_first(), c.of_points(look.whose), y, {of[0], fetch});
    add_pair_energy("contact.energy_edges", s, c.edge_edges(), c.ee_env_first(), c.of_edges(look.whose), y, {of[1], fetch});
    add_planes(s, y, vertices, fetch);
  }
  void add_planes(const BarrierView& view, View<const Vec3> y, const device::Ranges& vertices, device::Fetch& fetch) {
    const BarrierView s = view;
    for (Index p = 0; p < s.planes.n; ++p) {
      const Index first = p * s.surface.vertices.n;
      device::env_sum(
          "contact.energy_planes", vertices, [=] MORTISE_HD(Index i) { return plane_energy(s, first + i, y); }, device::EnvValues{of[2 + p], fetch});
    }
  }
};

}  // namespace

void energy(const BarrierView& s, const Where& at, device::EnvValues per_env) {
  auto parts = std::make_shared<EnergyParts>();
  at.candidates.look(at.y, at.whose, parts->look, per_env.fetch);
  parts->find(s, at.candidates, at.y.view(), at.vertices, per_env.fetch);
  per_env.fetch.then([s, parts, &c = at.candidates, &y = at.y, vertices = at.vertices, &value = per_env.value] {
    std::vector<std::uint8_t> finite;
    if (c.settle(y, parts->look, finite)) {
      device::Fetch again;
      parts->find(s, c, y.view(), vertices, again);
      again.now("contact energies again");
    }
    for (const std::vector<double>& part : parts->of)
      for (std::size_t e = 0; e < value.size(); ++e) value[e] += part[e];
    forbid(finite, value);
  });
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
  fetch.now("least distances");
  for (std::size_t e = 0; e < envs; ++e) gap[e] = std::fmin(gap[e], std::sqrt(squared[e]));
  return gap;
}

}  // namespace mortise::effects::contact
