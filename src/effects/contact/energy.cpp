#include "effects/contact/active.h"
#include "effects/contact/select.h"

namespace mortise::effects::contact {
namespace {

// Sums only over the pairs in range, so that the order of the sum is a function of y, not of how many more candidates are held.
template <class Pair>
void add_pair_energy(const char* name, const Scene& s, View<const Pair> pairs, const std::vector<Index>& env_offset,
                     View<const Vec3> y, std::vector<double>& per_env) {
  Buffer<Index> at_buffer;
  const Index n = select(
      "contact.near", pairs.n, [=] MORTISE_HD(Index i) { return near(s, pairs[i], y); }, at_buffer);
  if (n == 0) return;
  const Buffer<Index> offset(env_offset);
  Buffer<Index> picked(n), bounds(offset.size());
  const View<const Index> at = at_buffer.view(), from = offset.view();
  const View<Index> list = picked.view(), bound = bounds.view();
  device::parallel_for("contact.pick", pairs.n, [=] MORTISE_HD(Index i) {
    if (at[i + 1] > at[i]) list[at[i]] = i;
  });
  device::parallel_for("contact.env_offset", from.n, [=] MORTISE_HD(Index e) { bound[e] = at[from[e]]; });
  device::env_sum(
      name, bounds.download(), [=] MORTISE_HD(Index i) { return pair_energy(s, pairs[list[i]], y); }, per_env);
}

}  // namespace

void energy(const Scene& s, const Candidates& c, View<const Vec3> y, const std::vector<Index>& vertex_env,
            std::vector<double>& per_env) {
  add_pair_energy("contact.energy_points", s, c.point_triangles(), c.pt_env_offset(), y, per_env);
  add_pair_energy("contact.energy_edges", s, c.edge_edges(), c.ee_env_offset(), y, per_env);
  for (Index p = 0; p < s.planes.n; ++p) {
    const Index first = p * s.surface.vertices.n;
    device::env_sum(
        "contact.energy_planes", vertex_env, [=] MORTISE_HD(Index i) { return plane_energy(s, first + i, y); }, per_env);
  }
}

void limit_planes(const Scene& s, View<const Vec3> y, View<const Vec3> dy, double keep, const std::vector<Index>& vertex_env,
                  std::vector<double>& alpha) {
  std::vector<double> negative(alpha.size());
  for (std::size_t e = 0; e < alpha.size(); ++e) negative[e] = -alpha[e];
  for (Index p = 0; p < s.planes.n; ++p)
    device::env_max(
        "contact.limit_planes", vertex_env,
        [=] MORTISE_HD(Index i) {
          const Index point = s.surface.vertices[i];
          if (!s.plane_watched[p * s.surface.bodies + s.surface.body[point]]) return -2.0;
          const double gap = s.planes[p].normal.dot(y[point] - s.planes[p].point), rate = -s.planes[p].normal.dot(dy[point]);
          if (!(rate > 0)) return -2.0;
          return gap > 0 ? -(1 - keep) * gap / rate : 0.0;
        },
        negative);
  for (std::size_t e = 0; e < alpha.size(); ++e) alpha[e] = -negative[e];
}

}  // namespace mortise::effects::contact
