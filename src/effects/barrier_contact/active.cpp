#include "effects/barrier_contact/active.h"

#include "model/expand.h"

namespace mortise::effects::contact {
namespace {

using model::ContactSample;

constexpr std::uint64_t kNoKey = ~0ull;

// Distinct terms that one point-triangle candidate contributes to: its closest feature, its edges and its vertices.
constexpr Index kSlots = 7;

// Offsets of those i < n that `keep` wants; returns how many. i is kept where offset[i+1] > offset[i].
template <class Keep>
Index select(const char* name, Index n, Keep keep, Buffer<Index>& offset) {
  offset.resize(n + 1);
  const View<Index> o = offset.view();
  device::parallel_for(name, n + 1, [=] MORTISE_HD(Index i) { o[i] = i < n && keep(i) ? 1 : 0; });
  return device::exclusive_scan(offset);
}

// Features by number: vertices first, then edges, then triangles, so that a term (point, feature) is one 64-bit key.
MORTISE_HD inline std::uint64_t term_key(Index point, Index feature) {
  return static_cast<std::uint64_t>(point) << 32 | static_cast<std::uint64_t>(feature);
}
MORTISE_HD inline Index vertex_feature(Index v) { return v; }
MORTISE_HD inline Index edge_feature(const Scene& s, Index e) { return s.rest.n + e; }
MORTISE_HD inline Index triangle_feature(const Scene& s, Index t) { return s.rest.n + s.surface.edges.n + t; }

// The feature of a triangle's corner or side that a closest point lies on; c.w marks the corners that take part.
MORTISE_HD inline Index feature_of(const Scene& s, const PointTriangle& pair, const Closest& c) {
  if (c.type == geometry::Feature::point_triangle) return triangle_feature(s, pair.triangle);
  for (int k = 0; k < 3; ++k) {
    const int j = (k + 1) % 3;
    if (c.type == geometry::Feature::point_edge && c.dw[0][1 + k] != 0 && c.dw[0][1 + j] != 0)
      return edge_feature(s, s.topology.triangle_edge[3 * pair.triangle + k]);
    if (c.type == geometry::Feature::point_point && c.w[1 + k] != 0) return vertex_feature(pair.v[1 + k]);
  }
  return -1;
}

// Writes the keys and coefficients of one candidate within range.
MORTISE_HD inline void write_terms(const Scene& s, const PointTriangle& pair, View<const Vec3> y, std::uint64_t* key, Index* coefficient) {
  for (Index k = 0; k < kSlots; ++k) key[k] = kNoKey, coefficient[k] = 0;
  Vec3 x[4];
  gather(y, pair.v, x);
  const double range = s.law.d_hat * s.law.d_hat;
  key[0] = term_key(pair.point, feature_of(s, pair, geometry::closest_point_triangle(x)));
  coefficient[0] = 1;
  if (!s.law.area_weighted) return;
  for (int k = 0; k < 3; ++k) {
    const Index edge = s.topology.triangle_edge[3 * pair.triangle + k];
    const Closest c = closest_on_segment(x, 1 + k, 1 + (k + 1) % 3);
    if (!(c.squared < range)) continue;
    key[1 + k] = term_key(pair.point, feature_of(s, pair, c));
    coefficient[1 + k] = edge_coefficient(s, pair.point, edge, pair.triangle);
  }
  for (int k = 0; k < 3; ++k) {
    if (!((x[0] - x[1 + k]).squaredNorm() < range)) continue;
    key[4 + k] = term_key(pair.point, vertex_feature(pair.v[1 + k]));
    coefficient[4 + k] = vertex_coefficient(s, pair.point, pair.v[1 + k], pair.triangle);
  }
}

MORTISE_HD inline Active point_term(const Scene& s, std::uint64_t key, Index coefficient) {
  const Index point = static_cast<Index>(key >> 32);
  Index feature = static_cast<Index>(key & 0xffffffffull);
  Active a{TermKind::vertex, s.surface.env[point], {point, -1, -1, -1}, -1, coefficient * point_weight(s, point), 0};
  if (feature < s.rest.n) {
    a.point[1] = feature;
    return a;
  }
  feature -= s.rest.n;
  if (feature < s.surface.edges.n) {
    a.kind = TermKind::edge;
    for (int k = 0; k < 2; ++k) a.point[1 + k] = s.surface.edges[feature].v[k];
    return a;
  }
  a.kind = TermKind::triangle;
  for (int k = 0; k < 3; ++k) a.point[1 + k] = s.surface.triangles[feature - s.surface.edges.n].v[k];
  return a;
}

MORTISE_HD inline bool near(const Scene& s, const PointTriangle& pair, View<const Vec3> y) {
  if (!s.sees(pair.v[0], pair.v[1])) return false;
  Vec3 x[4];
  gather(y, pair.v, x);
  return geometry::closest_point_triangle(x).squared < s.law.d_hat * s.law.d_hat;
}
MORTISE_HD inline bool near(const Scene& s, const EdgeEdge& pair, View<const Vec3> y) {
  if (!s.sees(pair.v[0], pair.v[2])) return false;
  Vec3 x[4];
  gather(y, pair.v, x);
  return geometry::closest_edge_edge(x).squared < s.law.edge_range * s.law.edge_range;
}

// Sums only over the pairs in range, so that the order of the sum is a function of y, not of how many more candidates are held.
template <class Pair>
void add_pair_energy(const char* name, const Scene& s, View<const Pair> pairs, const std::vector<Index>& env_offset, View<const Vec3> y, std::vector<double>& per_env) {
  Buffer<Index> at_buffer;
  const Index n = select("barrier_contact.near", pairs.n, [=] MORTISE_HD(Index i) { return near(s, pairs[i], y); }, at_buffer);
  if (n == 0) return;
  const Buffer<Index> offset(env_offset);
  Buffer<Index> picked(n), bounds(offset.size());
  const View<const Index> at = at_buffer.view(), from = offset.view();
  const View<Index> list = picked.view(), bound = bounds.view();
  device::parallel_for("barrier_contact.pick", pairs.n, [=] MORTISE_HD(Index i) {
    if (at[i + 1] > at[i]) list[at[i]] = i;
  });
  device::parallel_for("barrier_contact.env_offset", from.n, [=] MORTISE_HD(Index e) { bound[e] = at[from[e]]; });
  device::env_sum(name, bounds.download(), [=] MORTISE_HD(Index i) { return pair_energy(s, pairs[list[i]], y); }, per_env);
}

// Point-triangle terms: every candidate within range writes its terms, equal ones are merged by sorting, and those that cancel
// (all of them, away from the closest feature on a flat surface) disappear.
Index point_terms(const Scene& s, View<const PointTriangle> pairs, View<const Vec3> y, Buffer<std::uint64_t>& keys, Buffer<Index>& start,
                  Buffer<Index>& total, Buffer<Index>& kept) {
  Buffer<Index> in_range;
  const Index hits = select("barrier_contact.near", pairs.n, [=] MORTISE_HD(Index i) { return near(s, pairs[i], y); }, in_range);
  if (hits == 0) return 0;
  const Index slots = s.law.area_weighted ? kSlots : 1;
  keys.resize(hits * slots);
  Buffer<Index> slot(hits * slots), coefficient(hits * slots);
  const View<std::uint64_t> key = keys.view();
  const View<Index> place = slot.view(), value = coefficient.view();
  const View<const Index> at = in_range.view();
  device::parallel_for("barrier_contact.terms", pairs.n, [=] MORTISE_HD(Index i) {
    if (at[i + 1] == at[i]) return;
    std::uint64_t k[kSlots];
    Index c[kSlots];
    write_terms(s, pairs[i], y, k, c);
    for (Index j = 0; j < slots; ++j) {
      const Index to = at[i] * slots + j;
      key[to] = k[j], value[to] = c[j], place[to] = to;
    }
  });
  device::sort_pairs(keys, slot);
  device::run_starts(keys, start);
  // Sorting may exchange the buffers' memory: views from here on.
  const View<const std::uint64_t> sorted_key = keys.view();
  const View<const Index> sorted = slot.view();
  device::segment_sum("barrier_contact.merge", start, [=] MORTISE_HD(Index j) { return value[sorted[j]]; }, total);
  const View<const Index> sum = total.view(), first = start.view();
  return select("barrier_contact.keep", total.size(), [=] MORTISE_HD(Index r) { return sum[r] != 0 && sorted_key[first[r]] != kNoKey; }, kept);
}

// Environment by environment, keeping the order within each.
void group_by_environment(ActiveSet& set, Index envs) {
  const Index n = set.terms.size();
  if (envs > 1 && n > 0) {
    Buffer<std::uint64_t> keys(n);
    Buffer<Index> order(n);
    Buffer<Active> grouped(n);
    const View<std::uint64_t> key = keys.view();
    const View<Index> o = order.view();
    const View<const Active> from = set.terms.view();
    device::parallel_for("barrier_contact.env_key", n, [=] MORTISE_HD(Index i) { key[i] = static_cast<std::uint64_t>(from[i].env), o[i] = i; });
    device::sort_pairs(keys, order);
    const View<Active> to = grouped.view();
    const View<const Index> sorted = order.view();
    device::parallel_for("barrier_contact.env_order", n, [=] MORTISE_HD(Index i) { to[i] = from[sorted[i]]; });
    set.terms.swap(grouped);
  }
  set.env_offset.assign(envs + 1, 0);
  set.env_offset[envs] = n;
  if (envs == 1) return;
  Buffer<Index> bounds(envs + 1);
  const View<Index> out = bounds.view();
  const View<const Active> terms = set.terms.view();
  device::parallel_for("barrier_contact.env_offset", envs + 1, [=] MORTISE_HD(Index e) {
    Index lo = 0, hi = n;  // first term of an environment >= e
    while (lo < hi) {
      const Index mid = (lo + hi) / 2;
      if (terms[mid].env < e)
        lo = mid + 1;
      else
        hi = mid;
    }
    out[e] = lo;
  });
  set.env_offset = bounds.download();
}

MORTISE_HD inline Index points_of(TermKind kind) { return kind == TermKind::plane ? 1 : kind == TermKind::vertex ? 2 : kind == TermKind::edge ? 3 : 4; }

// A term as four points and the closest points between them. Unused points stand at the first one.
MORTISE_HD inline Closest closest(const Active& a, View<const Vec3> y, Vec3 x[4]) {
  gather(y, a.point, x);
  switch (a.kind) {
    case TermKind::triangle: return geometry::closest_point_triangle(x);
    case TermKind::edge: return closest_on_segment(x, 1, 2);
    case TermKind::edge_edge: return geometry::closest_edge_edge(x);
    default: break;
  }
  Closest c;
  c.w[0] = 1, c.w[1] = -1;
  c.squared = (x[0] - x[1]).squaredNorm();
  return c;
}
MORTISE_HD inline double range_of(const Scene& s, const Active& a) { return a.kind == TermKind::edge_edge ? s.law.edge_range : s.law.d_hat; }

struct NoHessian {
  MORTISE_HD void operator()(double, const Vec3*) const {}
};

// Gradient per point.
template <class Add>
MORTISE_HD inline void differentiate(const Scene& s, const Active& a, View<const Vec3> y, bool hessian, Vec3 grad[4], Add& add) {
  if (a.kind == TermKind::plane) {
    const Plane p = s.planes[a.plane];
    const double g = p.normal.dot(y[a.point[0]] - p.point), k = s.law.kappa * a.weight;
    grad[0] = k * barrier::first(g, s.law.d_hat) * p.normal;
    if (hessian) {
      const Vec3 v[4] = {p.normal, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      add(k * barrier::second(g, s.law.d_hat), v);
    }
    return;
  }
  Vec3 x[4];
  Frame f;
  const Closest c = closest(a, y, x);
  evaluate(c, x, range_of(s, a), s.law.kappa * a.weight, a.eps, hessian, f, grad, add);
}

// Adds the positive rank-one terms to the Hessian of a stencil; what is dropped makes it positive semi-definite. Terms of negative
// weight keep what is positive of them.
struct AddProjected {
  const model::Expansion<4>& e;
  const linalg::StencilView& out;
  Index stencil;
  MORTISE_HD void operator()(double c, const Vec3* v) const {
    if (!(c > 0)) return;
    Vec3 V[16];
    e.chain(v, V);
    model::add_rank_one(out, stencil, e.blocks, c, V);
  }
};

MORTISE_HD inline ContactSample sample_of(const Scene& s, const Active& a, View<const Vec3> y) {
  ContactSample out;
  for (Index k = 0; k < model::kSamplePoints; ++k) out.point[k] = -1, out.weight[k] = 0;
  out.points = points_of(a.kind);
  for (Index k = 0; k < out.points; ++k) out.point[k] = a.point[k];
  out.env = a.env;
  out.body_a = s.surface.body[a.point[0]];
  const double k = s.law.kappa * a.weight;
  Vec3 n, place;
  if (a.kind == TermKind::plane) {
    const Plane p = s.planes[a.plane];
    n = p.normal;
    out.gap = n.dot(y[a.point[0]] - p.point);
    out.weight[0] = 1;
    out.force = -k * barrier::first(out.gap, s.law.d_hat);
    out.body_b = s.surface.bodies + a.plane;
    place = y[a.point[0]] - out.gap / 2 * n;
  } else {
    Vec3 x[4];
    const Closest c = closest(a, y, x);
    const Frame f = frame(c, x);
    n = -f.n;  // from the first primitive to the second
    out.gap = f.d;
    place = Vec3::Zero();
    for (Index j = 0; j < out.points; ++j) out.weight[j] = -f.w[j];
    for (Index j = 0; j < 4; ++j) place += std::abs(f.w[j]) / 2 * x[j];
    const double m = a.eps > 0 ? geometry::mollifier(x, a.eps) : 1;
    out.force = -k * m * barrier::first(f.d, range_of(s, a));
    out.body_b = s.surface.body[a.point[a.kind == TermKind::edge_edge ? 2 : 1]];
  }
  out.area = s.law.area_weighted && a.kind != TermKind::edge_edge ? a.weight : 0;
  out.pressure = out.area > 0 ? out.force / out.area : 0;
  if (!(out.force > 0)) out.force = 0;
  for (int i = 0; i < 3; ++i) out.normal[i] = n[i], out.position[i] = place[i];
  return out;
}

}  // namespace

void face_planes(const Scene& s, View<const Vec3> y, View<double> plane_area) {
  const Index n = s.surface.vertices.n;
  device::parallel_for("barrier_contact.face_planes", plane_area.n,
                       [=] MORTISE_HD(Index i) { plane_area[i] = facing_area(s, s.surface.vertices[i % n], s.planes[i / n].normal, y); });
}

void face_points(const Scene& s, const ActiveSet& set, View<const Vec3> y, View<double> point_area) {
  const View<const Active> terms = set.terms.view();
  device::parallel_for("barrier_contact.face_points", terms.n, [=] MORTISE_HD(Index i) {
    const Index point = terms[i].point[0];
    const auto mine = [&](Index j) { return j >= 0 && j < terms.n && terms[j].kind <= TermKind::triangle && terms[j].point[0] == point; };
    if (!mine(i) || mine(i - 1)) return;  // the first of the point's terms speaks for all
    Vec3 force = Vec3::Zero();
    for (Index j = i; mine(j); ++j) {
      Vec3 grad[4];
      NoHessian none;
      differentiate(s, terms[j], y, false, grad, none);
      force -= grad[0];
    }
    const double size = force.norm();
    if (size > 0) point_area[point] = facing_area(s, point, force / size, y);
  });
}

void energy(const Scene& s, const Candidates& c, View<const Vec3> y, const std::vector<Index>& vertex_env, std::vector<double>& per_env) {
  add_pair_energy("barrier_contact.energy_points", s, c.point_triangles(), c.pt_env_offset(), y, per_env);
  add_pair_energy("barrier_contact.energy_edges", s, c.edge_edges(), c.ee_env_offset(), y, per_env);
  for (Index p = 0; p < s.planes.n; ++p) {
    const Index first = p * s.surface.vertices.n;
    device::env_sum("barrier_contact.energy_planes", vertex_env, [=] MORTISE_HD(Index i) { return plane_energy(s, first + i, y); }, per_env);
  }
}

void build(const Scene& s, const Candidates& c, View<const Vec3> y, Index envs, ActiveSet& out) {
  Buffer<std::uint64_t> keys;
  Buffer<Index> start, total, kept, edges_at, planes_at;
  const Index points = point_terms(s, c.point_triangles(), y, keys, start, total, kept);

  const View<const EdgeEdge> ee = c.edge_edges();
  const Index edges = select("barrier_contact.near", ee.n, [=] MORTISE_HD(Index i) { return near(s, ee[i], y); }, edges_at);
  const Index plane_pairs = s.planes.n * s.surface.vertices.n;
  const Index planes = select(
      "barrier_contact.near_planes", plane_pairs,
      [=] MORTISE_HD(Index i) {
        Index plane, point;
        double gap;
        return plane_pair(s, i, y, plane, point, gap);
      },
      planes_at);

  out.terms.resize(points + edges + planes);
  const View<Active> terms = out.terms.view();
  if (points > 0) {
    const View<const std::uint64_t> key = keys.view();
    const View<const Index> first = start.view(), sum = total.view(), at = kept.view();
    device::parallel_for("barrier_contact.point_terms", sum.n, [=] MORTISE_HD(Index r) {
      if (at[r + 1] > at[r]) terms[at[r]] = point_term(s, key[first[r]], sum[r]);
    });
  }
  const View<const Index> edge_at = edges_at.view(), plane_at = planes_at.view();
  device::parallel_for("barrier_contact.edge_terms", ee.n, [=] MORTISE_HD(Index i) {
    if (edge_at[i + 1] == edge_at[i]) return;
    const EdgeEdge p = ee[i];
    Vec3 rest[4];
    gather(s.rest, p.v, rest);
    terms[points + edge_at[i]] = {TermKind::edge_edge, s.surface.env[p.v[0]], {p.v[0], p.v[1], p.v[2], p.v[3]}, -1, edge_weight(s, p.a, p.b), geometry::mollifier_threshold(rest)};
  });
  device::parallel_for("barrier_contact.plane_terms", plane_pairs, [=] MORTISE_HD(Index i) {
    if (plane_at[i + 1] == plane_at[i]) return;
    Index plane, point;
    double gap;
    plane_pair(s, i, y, plane, point, gap);
    terms[points + edges + plane_at[i]] = {TermKind::plane, s.surface.env[point], {point, -1, -1, -1}, plane, plane_weight(s, i), 0};
  });
  group_by_environment(out, envs);
}

void assemble(const Scene& s, const ActiveSet& set, View<const Vec3> y, const model::PointMapView& map, bool hessian, linalg::StencilSet& stencils) {
  const View<const Active> terms = set.terms.view();
  Buffer<Index> counts(terms.n + 1);
  const View<Index> count = counts.view();
  device::parallel_for("barrier_contact.count_blocks", terms.n, [=] MORTISE_HD(Index i) {
    count[i] = model::expand<4>(map, terms[i].point, points_of(terms[i].kind)).blocks;
  });
  stencils.resize(std::move(counts));
  const linalg::StencilView out = stencils.view();
  device::parallel_for("barrier_contact.assemble", terms.n, [=] MORTISE_HD(Index i) {
    const model::Expansion<4> e = model::expand<4>(map, terms[i].point, points_of(terms[i].kind));
    const Index at = out.offset[i];
    for (Index b = 0; b < e.blocks; ++b) out.block[at + b] = e.block[b];
    if (hessian) model::zero_hessian(out, i, e.blocks);
    AddProjected add{e, out, i};
    Vec3 grad[4];
    differentiate(s, terms[i], y, hessian, grad, add);
    e.chain(grad, out.grad.p + at);
  });
}

void samples(const Scene& s, const ActiveSet& set, View<const Vec3> y, Buffer<ContactSample>& out) {
  const View<const Active> terms = set.terms.view();
  out.resize(terms.n);
  const View<ContactSample> to = out.view();
  device::parallel_for("barrier_contact.samples", terms.n, [=] MORTISE_HD(Index i) { to[i] = sample_of(s, terms[i], y); });
}

void point_forces(const Scene& s, const ActiveSet& set, View<const Vec3> y, Buffer<Vec3>& out) {
  const View<const Active> terms = set.terms.view();
  out.resize(4 * terms.n);
  const View<Vec3> to = out.view();
  device::parallel_for("barrier_contact.forces", terms.n, [=] MORTISE_HD(Index i) {
    Vec3 grad[4] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    NoHessian none;
    differentiate(s, terms[i], y, false, grad, none);
    for (Index k = 0; k < 4; ++k) to[4 * i + k] = -grad[k];
  });
}

void limit_planes(const Scene& s, View<const Vec3> y, View<const Vec3> dy, double keep, const std::vector<Index>& vertex_env, std::vector<double>& alpha) {
  std::vector<double> negative(alpha.size());
  for (std::size_t e = 0; e < alpha.size(); ++e) negative[e] = -alpha[e];
  for (Index p = 0; p < s.planes.n; ++p)
    device::env_max(
        "barrier_contact.limit_planes", vertex_env,
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
