#include "geometry/collide/pair_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/collide/tuning.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

MORTISE_HD inline bool contains(const Index* v, int n, Index point) {
  for (int i = 0; i < n; ++i)
    if (v[i] == point) return true;
  return false;
}

MORTISE_HD inline void sift_down(Index* v, Index stride, Index root, Index n) {
  const Index value = v[root * stride];
  for (Index child = 2 * root + 1; child < n; child = 2 * root + 1) {
    if (child + 1 < n && v[(child + 1) * stride] > v[child * stride]) ++child;
    if (v[child * stride] <= value) break;
    v[root * stride] = v[child * stride];
    root = child;
  }
  v[root * stride] = value;
}

// Heap sort of v[0], v[stride], ...: in place, and no worse than n log n for the few points with very many pairs.
MORTISE_HD inline void sort_strided(Index* v, Index stride, Index n) {
  for (Index i = n / 2 - 1; i >= 0; --i) sift_down(v, stride, i, n);
  for (Index i = n - 1; i > 0; --i) {
    const Index top = v[0];
    v[0] = v[i * stride];
    v[i * stride] = top;
    sift_down(v, stride, 0, i);
  }
}

// Threads that walk a tree: the same number for each query, those of a query side by side.
struct Walkers {
  Index of_query;
  MORTISE_HD Index query(Index walker) const { return walker / of_query; }
  MORTISE_HD BvhCursor cursor(Index walker) const { return {walker % of_query, of_query}; }
  MORTISE_HD Index noted() const { return tuning::kNoted / of_query; }  // by each
  Index all(View<const Index> queries) const { return queries.n * of_query; }
};

// Ids found by a walker: every stride-th Index from `to` on, as many as there is room for.
struct Notes {
  Index* to;
  Index stride, room;
  MORTISE_HD void put(Index k, Index id) const {
    if (k < room) to[k * stride] = id;
  }
};

// Counts the triangles near a point that a walker comes by, and notes their ids.
MORTISE_HD inline Index triangles_near(const BvhView& tree, const SurfaceView& s, Index point, BvhCursor cursor, View<const Vec3> y,
                                       View<const Vec3> dy, double radius, const Notes& notes) {
  const BvhNode box = swept_box(&point, 1, -1, s, y, dy, radius / 2);
  Index n = 0;
  for (Index t = cursor.next(tree, box, s); t >= 0; t = cursor.next(tree, box, s)) {
    const Index* c = s.triangles[t].v;
    if (contains(c, 3, point)) continue;
    const Index v[4] = {point, c[0], c[1], c[2]};
    if (s.body[point] == s.body[c[0]] && stay_apart(v, 1, y, dy, radius)) continue;
    notes.put(n++, t);
  }
  return n;
}

MORTISE_HD inline Index edges_near(const BvhView& tree, const SurfaceView& s, Index edge, BvhCursor cursor, View<const Vec3> y, View<const Vec3> dy,
                                   double radius, const Notes& notes) {
  const Edge a = s.edges[edge];
  const BvhNode box = swept_box(a.v, 2, edge, s, y, dy, radius / 2);
  Index n = 0;
  for (Index b = cursor.next(tree, box, s); b >= 0; b = cursor.next(tree, box, s)) {
    const Index* c = s.edges[b].v;
    if (contains(c, 2, a.v[0]) || contains(c, 2, a.v[1])) continue;
    const Index v[4] = {a.v[0], a.v[1], c[0], c[1]};
    if (s.body[a.v[0]] == s.body[c[0]] && stay_apart(v, 2, y, dy, radius)) continue;
    notes.put(n++, b);
  }
  return n;
}

void count_point_triangles(const SurfaceView& s, Walkers w, const BvhView& tree, View<const Index> points, const device::Ranges& whose,
                           View<const Vec3> y, View<const Vec3> dy, Radius radius, Buffer<Index>& counts, Buffer<Index>& noted) {
  counts.resize(w.all(points) + 1);
  if (whose.size() < w.all(points)) counts.zero();
  noted.resize(points.n * tuning::kNoted);
  const View<Index> note = noted.view();
  const View<Index> count = counts.view();
  device::parallel_for("broadphase.count_point_triangle", whose, [=] MORTISE_HD(Index i) {
    const Index point = points[w.query(i)];
    count[i] = triangles_near(tree, s, point, w.cursor(i), y, dy, radius[s.env[point]], {note.p + i * w.noted(), 1, w.noted()});
  });
}

void fill_point_triangles(const SurfaceView& s, Walkers w, const BvhView& tree, View<const Index> points, View<const Vec3> y, View<const Vec3> dy,
                          Radius radius, View<const Index> count, View<const Index> note, View<PointTriangle> out) {
  constexpr Index kStride = sizeof(PointTriangle) / sizeof(Index);
  device::parallel_for("broadphase.fill_point_triangle", w.all(points), [=] MORTISE_HD(Index i) {
    const Index n = count[i + 1] - count[i], point = points[w.query(i)];
    if (n == 0) return;
    const Notes to{&out[count[i]].triangle, kStride, n};
    if (n > w.noted())
      triangles_near(tree, s, point, w.cursor(i), y, dy, radius[s.env[point]], to);
    else
      for (Index k = 0; k < n; ++k) to.put(k, note[i * w.noted() + k]);
  });
  device::parallel_for("broadphase.sort_point_triangle", points.n, [=] MORTISE_HD(Index i) {
    const Index first = count[i * w.of_query], n = count[(i + 1) * w.of_query] - first, point = points[i];
    if (n == 0) return;
    PointTriangle* mine = out.p + first;
    sort_strided(&mine->triangle, kStride, n);
    for (Index k = 0; k < n; ++k) {
      const Triangle t = s.triangles[mine[k].triangle];
      mine[k].point = mine[k].v[0] = point;
      for (int c = 0; c < 3; ++c) mine[k].v[1 + c] = t.v[c];
    }
  });
}

void count_edge_edges(const SurfaceView& s, Walkers w, const BvhView& tree, View<const Index> edges, const device::Ranges& whose, View<const Vec3> y,
                      View<const Vec3> dy, Radius radius, Buffer<Index>& counts, Buffer<Index>& noted) {
  counts.resize(w.all(edges) + 1);
  if (whose.size() < w.all(edges)) counts.zero();
  noted.resize(edges.n * tuning::kNoted);
  const View<Index> note = noted.view();
  const View<Index> count = counts.view();
  device::parallel_for("broadphase.count_edge_edge", whose, [=] MORTISE_HD(Index i) {
    const Index a = edges[w.query(i)];
    count[i] = edges_near(tree, s, a, w.cursor(i), y, dy, radius[s.env[s.edges[a].v[0]]], {note.p + i * w.noted(), 1, w.noted()});
  });
}

void fill_edge_edges(const SurfaceView& s, Walkers w, const BvhView& tree, View<const Index> edges, View<const Vec3> y, View<const Vec3> dy,
                     Radius radius, View<const Index> count, View<const Index> note, View<EdgeEdge> out) {
  constexpr Index kStride = sizeof(EdgeEdge) / sizeof(Index);
  device::parallel_for("broadphase.fill_edge_edge", w.all(edges), [=] MORTISE_HD(Index i) {
    const Index n = count[i + 1] - count[i], a = edges[w.query(i)];
    if (n == 0) return;
    const Notes to{&out[count[i]].b, kStride, n};
    if (n > w.noted())
      edges_near(tree, s, a, w.cursor(i), y, dy, radius[s.env[s.edges[a].v[0]]], to);
    else
      for (Index k = 0; k < n; ++k) to.put(k, note[i * w.noted() + k]);
  });
  device::parallel_for("broadphase.sort_edge_edge", edges.n, [=] MORTISE_HD(Index i) {
    const Index first = count[i * w.of_query], n = count[(i + 1) * w.of_query] - first, a = edges[i];
    if (n == 0) return;
    EdgeEdge* mine = out.p + first;
    sort_strided(&mine->b, kStride, n);
    for (Index k = 0; k < n; ++k) {
      mine[k].a = a;
      for (int c = 0; c < 2; ++c) {
        mine[k].v[c] = s.edges[a].v[c];
        mine[k].v[2 + c] = s.edges[mine[k].b].v[c];
      }
    }
  });
}

// Sorts queries by environment, keeping the order of ids, and notes where each environment starts.
void by_environment(std::vector<Index> queries, const std::vector<Index>& env_of, Index environments, Buffer<Index>& sorted,
                    std::vector<Index>& start, Index walkers, std::vector<Index>& walker_start, Buffer<Index>& first) {
  std::stable_sort(queries.begin(), queries.end(), [&](Index a, Index b) { return env_of[a] < env_of[b]; });
  start.assign(environments + 1, 0);
  for (Index q : queries) ++start[env_of[q] + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  walker_start = start;
  for (Index& w : walker_start) w *= walkers;
  sorted.upload(queries);
  first.upload(walker_start);
}

}  // namespace

PairSearch::PairSearch(const Surface& surface) : surface_(surface) {
  const std::vector<Index> env = surface.env.download();
  for (Index e : env) environments_ = std::max(environments_, e + 1);
  std::vector<Index> points = surface.vertices.download();
  std::sort(points.begin(), points.end());
  while (2 * walkers_ <= tuning::kMostWalkers && 2 * walkers_ * surface.edges.size() <= tuning::kThreads) walkers_ *= 2;
  by_environment(points, env, environments_, points_, point_env_offset_, walkers_, point_walkers_, point_env_first_);

  const std::vector<Edge> edges = surface.edges.download();
  std::vector<Index> ids(edges.size()), edge_env(edges.size());
  std::iota(ids.begin(), ids.end(), 0);
  for (std::size_t i = 0; i < edges.size(); ++i) edge_env[i] = env[edges[i].v[0]];
  by_environment(ids, edge_env, environments_, edges_, edge_env_offset_, walkers_, edge_walkers_, edge_env_first_);

  triangle_env_offset_.assign(environments_ + 1, 0);
  for (const Triangle& t : surface.triangles.download()) ++triangle_env_offset_[env[t.v[0]] + 1];
  std::partial_sum(triangle_env_offset_.begin(), triangle_env_offset_.end(), triangle_env_offset_.begin());
}

void PairSearch::find(View<const Vec3> y, View<const Vec3> dy, const std::vector<double>& radius, const std::vector<std::uint8_t>& whose,
                      NearPairs& out) {
  count(y, dy, radius, whose, out);
  fill(y, dy, out);
}

const NearPairs::Sums& PairSearch::count(View<const Vec3> y, View<const Vec3> dy, const std::vector<double>& radius,
                                         const std::vector<std::uint8_t>& whose, NearPairs& out) {
  const SurfaceView s = surface_.view();
  Radius& r = asked_ = {radius[0]};
  if (std::any_of(radius.begin(), radius.end(), [&](double one) { return one != radius[0]; })) {
    radius_.upload(radius);
    r.each = std::as_const(radius_).view();
  }
  const device::Ranges triangles_of(triangle_env_offset_, whose), edges_of(edge_env_offset_, whose);
  triangle_tree_.update({s.triangles.n ? s.triangles.p->v : nullptr, s.triangles.n, 3}, s, environments_, y, dy, {.radius = r}, &triangles_of);
  edge_tree_.update({s.edges.n ? s.edges.p->v : nullptr, s.edges.n, 2}, s, environments_, y, dy, {.radius = r}, &edges_of);
  const device::Ranges point_walkers(point_walkers_, whose), edge_walkers(edge_walkers_, whose);
  count_point_triangles(s, {walkers_}, triangle_tree_.view(), std::as_const(points_).view(), point_walkers, y, dy, r, pt_counts_, pt_noted_);
  count_edge_edges(s, {walkers_}, edge_tree_.view(), std::as_const(edges_).view(), edge_walkers, y, dy, r, ee_counts_, ee_noted_);
  device::Fetch fetch;
  out.begin_add_up({pt_counts_, point_walkers, point_env_first_.view()}, {ee_counts_, edge_walkers, edge_env_first_.view()}, sums_, fetch);
  fetch.now("pairs");
  return sums_;
}

void PairSearch::fill(View<const Vec3> y, View<const Vec3> dy, NearPairs& out) {
  const SurfaceView s = surface_.view();
  out.end_add_up(sums_);
  fill_point_triangles(s, {walkers_}, triangle_tree_.view(), std::as_const(points_).view(), y, dy, asked_, std::as_const(pt_counts_).view(),
                       std::as_const(pt_noted_).view(), out.point_triangles.view());
  fill_edge_edges(s, {walkers_}, edge_tree_.view(), std::as_const(edges_).view(), y, dy, asked_, std::as_const(ee_counts_).view(),
                  std::as_const(ee_noted_).view(), out.edge_edges.view());
}

}  // namespace mortise::geometry
