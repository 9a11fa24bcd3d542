#include "effects/contact/active.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "device/runs.h"
#include "effects/contact/select.h"

namespace mortise::effects::contact {
namespace {

using device::kNoKey;

// Distinct terms that one point-triangle candidate contributes to: its closest feature, its edges and its vertices.
constexpr Index kSlots = 7;

// Features by number: vertices first, then edges, then triangles, so that a term (point, feature) is one 64-bit key.
MORTISE_HD inline std::uint64_t term_key(Index point, Index feature) {
  return static_cast<std::uint64_t>(point) << 32 | static_cast<std::uint64_t>(feature);
}
MORTISE_HD inline Index vertex_feature(Index v) { return v; }
MORTISE_HD inline Index edge_feature(const BarrierView& s, Index e) { return s.rest.n + e; }
MORTISE_HD inline Index triangle_feature(const BarrierView& s, Index t) { return s.rest.n + s.surface.edges.n + t; }

// The feature of a triangle's corner or side that a closest point lies on; c.w marks the corners that take part.
MORTISE_HD inline Index feature_of(const BarrierView& s, const PointTriangle& pair, const Closest& c) {
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
MORTISE_HD inline void write_terms(const BarrierView& s, const PointTriangle& pair, View<const Vec3> y, std::uint64_t* key, Index* coefficient) {
  for (Index k = 0; k < kSlots; ++k) key[k] = kNoKey, coefficient[k] = 0;
  Vec3 x[4];
  gather(y, pair.v, x);
  const double range = point_range(s, pair.v[0], pair.v[1]), range2 = range * range;
  key[0] = term_key(pair.point, feature_of(s, pair, geometry::closest_point_triangle(x)));
  coefficient[0] = 1;
  if (!s.barrier.area_weighted) return;
  for (int k = 0; k < 3; ++k) {
    const Index edge = s.topology.triangle_edge[3 * pair.triangle + k];
    const Closest c = closest_on_segment(x, 1 + k, 1 + (k + 1) % 3);
    if (!(c.squared < range2)) continue;
    key[1 + k] = term_key(pair.point, feature_of(s, pair, c));
    coefficient[1 + k] = edge_coefficient(s, pair.point, edge, pair.triangle);
  }
  for (int k = 0; k < 3; ++k) {
    if (!((x[0] - x[1 + k]).squaredNorm() < range2)) continue;
    key[4 + k] = term_key(pair.point, vertex_feature(pair.v[1 + k]));
    coefficient[4 + k] = vertex_coefficient(s, pair.point, pair.v[1 + k], pair.triangle);
  }
}

MORTISE_HD inline Active point_term(const BarrierView& s, std::uint64_t key, Index coefficient) {
  const Index point = static_cast<Index>(key >> 32);
  Index feature = static_cast<Index>(key & 0xffffffffull);
  Active a{TermKind::vertex, s.surface.env[point], {point, -1, -1, -1}, -1, 0, coefficient * point_weight(s, point), 0};
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

// Point-triangle terms: each of the candidates within range, for which there is `room`, writes its terms, equal ones are merged by sorting, and
// those that cancel (all of them, away from the closest feature on a flat surface) disappear.
void point_terms(const BarrierView& s, View<const PointTriangle> pairs, View<const Vec3> y, const Buffer<Index>& in_range, Index room,
                 PointTerms& out) {
  const Index slots = s.barrier.area_weighted ? kSlots : 1, n = room * slots;
  out.key.resize(n);
  Buffer<Index> slot(n), coefficient(n), runs;
  const View<std::uint64_t> key = out.key.view();
  const View<Index> place = slot.view(), value = coefficient.view();
  const View<const Index> at = in_range.view();
  device::parallel_for("contact.terms", pairs.n, [=] MORTISE_HD(Index i) {
    if (at[i + 1] == at[i] || at[i] >= room) return;
    std::uint64_t k[kSlots];
    Index c[kSlots];
    write_terms(s, pairs[i], y, k, c);
    for (Index j = 0; j < slots; ++j) {
      const Index to = at[i] * slots + j;
      key[to] = k[j], value[to] = c[j], place[to] = to;
    }
  });
  device::parallel_for("contact.no_terms", n, [=] MORTISE_HD(Index j) {
    if (j / slots >= at[pairs.n]) key[j] = kNoKey, place[j] = j;
  });
  device::sort_pairs(out.key, slot);
  device::mark_runs(out.key, runs);
  device::start_runs(out.key, runs, n, out.start);
  device::empty_runs(runs, out.start);
  // Sorting may exchange the buffers' memory: views from here on.
  const View<const Index> sorted = slot.view(), first = std::as_const(out.start).view();
  out.sum.resize(n);
  const View<Index> sum = out.sum.view();
  mark(
      "contact.merge", n,
      [=] MORTISE_HD(Index r) {
        Index t = 0;
        for (Index j = first[r]; j < first[r + 1]; ++j) t += value[sorted[j]];
        sum[r] = t;
        return t != 0;
      },
      out.kept);
}

// The number that scan() left behind the counts.
View<const Index> total_of(const Buffer<Index>& scanned) { return {scanned.view().p + (scanned.size() - 1), 1}; }

// Environment by environment, keeping the order within each; places without a term are of none, and come last.
void group_by_environment(ActiveSet& set, Index envs, device::Fetch& fetch) {
  const Index n = set.terms.size();
  if (envs == 1) return;
  if (n > 0) {
    Buffer<std::uint64_t> keys(n);
    Buffer<Index> order(n);
    Buffer<Active> grouped(n);
    const View<std::uint64_t> key = keys.view();
    const View<Index> o = order.view();
    const View<const Active> from = set.terms.view();
    device::parallel_for("contact.env_key", n, [=] MORTISE_HD(Index i) { key[i] = static_cast<std::uint64_t>(from[i].env), o[i] = i; });
    device::sort_pairs(keys, order, std::bit_width(static_cast<std::uint64_t>(envs)));
    const View<Active> to = grouped.view();
    const View<const Index> sorted = order.view();
    device::parallel_for("contact.env_order", n, [=] MORTISE_HD(Index i) { to[i] = from[sorted[i]]; });
    set.terms.swap(grouped);
  }
  Buffer<Index> bounds(envs + 1);
  const View<Index> out = bounds.view();
  const View<const Active> terms = set.terms.view();
  device::parallel_for("contact.env_offset", envs + 1, [=] MORTISE_HD(Index e) {
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
  fetch.add(View<const Index>(out), set.env_offset);
  fetch.keep(std::move(bounds));
}

// Pairs of half-spaces and vertices: all vertices towards the first, then towards the next.
device::Ranges pairs_with_planes(const device::Ranges& vertices, Index planes, Index all) {
  std::vector<Index> bound{0};
  std::vector<std::uint8_t> taken;
  for (Index p = 0; p < planes; ++p)
    for (const device::Ranges::Part& part : vertices.parts()) {
      bound.push_back(p * all + part.begin), taken.push_back(0);
      bound.push_back(p * all + part.end), taken.push_back(1);
    }
  return {bound, taken};
}

}  // namespace

void TermSearch::begin(const BarrierView& view, const Where& at, const TermRoom& room, const model::PointMapView* map, ActiveSet& out,
                       linalg::StencilSet* stencils, device::Fetch& fetch) {
  where_.emplace(at), out_ = &out;
  const BarrierView s = view;
  Candidates& c = at.candidates;
  const View<const Vec3> y = at.y.view();
  c.look(at.y, at.whose, look_, fetch);
  const View<const PointTriangle> pt = c.point_triangles();
  mark(
      "contact.near", pt.n, c.of_points(at.whose), [=] MORTISE_HD(Index i) { return near(s, pt[i], y); }, points_at_);
  const View<const EdgeEdge> ee = c.edge_edges();
  mark(
      "contact.near", ee.n, c.of_edges(at.whose), [=] MORTISE_HD(Index i) { return near(s, ee[i], y); }, edges_at_);
  const Index plane_pairs = s.planes.n * s.surface.vertices.n;
  mark(
      "contact.near_planes", plane_pairs, pairs_with_planes(at.vertices, s.planes.n, s.surface.vertices.n),
      [=] MORTISE_HD(Index i) {
        Index plane, point;
        double gap;
        return plane_pair(s, i, y, plane, point, gap);
      },
      planes_at_);
  const Index vertices = at.vertices.size(), envs = at.vertices.environments();
  most_ = std::min(room.hits.among(vertices), pt.n), places_ = room.terms.among(vertices);
  point_terms(s, pt, y, points_at_, most_, found_);
  fetch.add_total(points_at_, hits_);
  fetch.add_total(found_.kept, points_);
  fetch.add_total(edges_at_, edges_);
  fetch.add_total(planes_at_, planes_);

  out.terms.resize(places_);
  const View<Active> terms = out.terms.view();
  const View<const Index> of_points = total_of(found_.kept), of_edges = total_of(edges_at_), of_planes = total_of(planes_at_);
  const View<const std::uint64_t> key = std::as_const(found_.key).view();
  const View<const Index> first = std::as_const(found_.start).view(), sum = std::as_const(found_.sum).view(),
                          kept = std::as_const(found_.kept).view();
  device::parallel_for("contact.point_terms", sum.n, [=] MORTISE_HD(Index r) {
    if (kept[r + 1] > kept[r] && kept[r] < terms.n) terms[kept[r]] = point_term(s, key[first[r]], sum[r]);
  });
  const View<const Index> edge_at = std::as_const(edges_at_).view(), plane_at = std::as_const(planes_at_).view();
  device::parallel_for("contact.edge_terms", ee.n, [=] MORTISE_HD(Index i) {
    const Index to = of_points[0] + edge_at[i];
    if (edge_at[i + 1] == edge_at[i] || to >= terms.n) return;
    const EdgeEdge p = ee[i];
    Vec3 rest[4];
    gather(s.rest, p.v, rest);
    terms[to] = {
        TermKind::edge_edge, s.surface.env[p.v[0]], {p.v[0], p.v[1], p.v[2], p.v[3]}, -1, 0, edge_weight(s, p), geometry::mollifier_threshold(rest)};
  });
  device::parallel_for("contact.plane_terms", plane_pairs, [=] MORTISE_HD(Index i) {
    const Index to = of_points[0] + of_edges[0] + plane_at[i];
    if (plane_at[i + 1] == plane_at[i] || to >= terms.n) return;
    Index plane, point;
    double gap;
    plane_pair(s, i, y, plane, point, gap);
    terms[to] = {TermKind::plane, s.surface.env[point], {point, -1, -1, -1}, plane, 0, plane_weight(s, i, point), 0};
  });
  device::parallel_for("contact.no_terms", terms.n, [=] MORTISE_HD(Index i) {
    if (i >= of_points[0] + of_edges[0] + of_planes[0]) terms[i] = {TermKind::vertex, envs, {-1, -1, -1, -1}, -1, 0, 0, 0};
  });
  group_by_environment(out, envs, fetch);
  if (stencils) {
    Buffer<Index> counts;
    count_blocks(out, *map, counts);
    stencils->begin_resize(std::move(counts), fetch);
  }
}

bool TermSearch::end(TermRoom& room) {
  std::vector<std::uint8_t> finite;
  const bool missing = where_->candidates.settle(where_->y, look_, finite);
  const Index all = points_ + edges_ + planes_, vertices = where_->vertices.size();
  const bool small = hits_ > most_ || all > places_;
  room.hits.found(hits_, vertices);
  room.terms.found(hits_ > most_ ? std::max(all, hits_ + edges_ + planes_) : all, vertices);
  if (missing || small) return false;
  out_->terms.resize(all);
  out_->sizes = {};
  if (where_->vertices.environments() == 1) out_->env_offset = {0, all};
  return true;
}

void shape(ActiveSet& set, linalg::StencilSet& stencils) {
  stencils.end_resize(set.terms.size());
  set.sizes = stencils.sizes();
}

namespace {

void find(const BarrierView& s, const Where& at, TermRoom& room, const model::PointMapView* map, ActiveSet& out, linalg::StencilSet* stencils) {
  for (bool done = false; !done;) {
    device::Fetch fetch;
    TermSearch search;
    search.begin(s, at, room, map, out, stencils, fetch);
    fetch.now("contact terms");
    done = search.end(room);
  }
}

}  // namespace

void build(const BarrierView& s, const Where& at, TermRoom& room, ActiveSet& out) { find(s, at, room, nullptr, out, nullptr); }

void build(const BarrierView& s, const Where& at, TermRoom& room, const model::PointMapView& map, ActiveSet& out, linalg::StencilSet& stencils) {
  find(s, at, room, &map, out, &stencils);
  shape(out, stencils);
}

}  // namespace mortise::effects::contact
