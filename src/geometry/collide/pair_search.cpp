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

// What a walker comes by near its query: told to `notes`, and counted.
struct TrianglesNear {
  SurfaceView s;
  BvhView tree;
  View<const Index> points;
  View<const Vec3> y, dy;
  Radius radii;
  MORTISE_HD Index operator()(Index query, BvhCursor cursor, const Notes& notes) const {
    const Index point = points[query];
    const double radius = radii[s.env[point]];
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
};

struct EdgesNear {
  SurfaceView s;
  BvhView tree;
  View<const Index> edges;
  View<const Vec3> y, dy;
  Radius radii;
  MORTISE_HD Index operator()(Index query, BvhCursor cursor, const Notes& notes) const {
    const Edge a = s.edges[edges[query]];
    const double radius = radii[s.env[a.v[0]]];
    const BvhNode box = swept_box(a.v, 2, edges[query], s, y, dy, radius / 2);
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
};

template <class Near>
void count_near(const char* name, const Near& near, Walkers w, View<const Index> queries, const device::Ranges& whose, Buffer<Index>& counts,
                Buffer<Index>& noted) {
  counts.resize(w.all(queries) + 1);
  if (whose.size() < w.all(queries)) counts.zero();
  noted.resize(queries.n * tuning::kNoted);
  const View<Index> note = noted.view(), count = counts.view();
  device::parallel_for(name, whose, [=] MORTISE_HD(Index i) { count[i] = near(w.query(i), w.cursor(i), {note.p + i * w.noted(), 1, w.noted()}); });
}

// The ids that were noted, or where there were too many those that another walk finds, every `stride` from `ids` on.
template <class Near>
void fill_near(const char* name, const Near& near, Walkers w, View<const Index> queries, View<const Index> count, View<const Index> note, Index* ids,
               Index stride) {
  device::parallel_for(name, w.all(queries), [=] MORTISE_HD(Index i) {
    const Index n = count[i + 1] - count[i];
    if (n == 0) return;
    const Notes to{ids + count[i] * stride, stride, n};
    if (n > w.noted())
      near(w.query(i), w.cursor(i), to);
    else
      for (Index k = 0; k < n; ++k) to.put(k, note[i * w.noted() + k]);
  });
}

template <class Pair>
constexpr Index kStride = sizeof(Pair) / sizeof(Index);

void complete(const SurfaceView& s, Walkers w, View<const Index> points, View<const Index> count, View<PointTriangle> out) {
  device::parallel_for("broadphase.sort_point_triangle", points.n, [=] MORTISE_HD(Index i) {
    const Index first = count[i * w.of_query], n = count[(i + 1) * w.of_query] - first, point = points[i];
    if (n == 0) return;
    PointTriangle* mine = out.p + first;
    sort_strided(&mine->triangle, kStride<PointTriangle>, n);
    for (Index k = 0; k < n; ++k) {
      const Triangle t = s.triangles[mine[k].triangle];
      mine[k].point = mine[k].v[0] = point;
      for (int c = 0; c < 3; ++c) mine[k].v[1 + c] = t.v[c];
    }
  });
}

void complete(const SurfaceView& s, Walkers w, View<const Index> edges, View<const Index> count, View<EdgeEdge> out) {
  device::parallel_for("broadphase.sort_edge_edge", edges.n, [=] MORTISE_HD(Index i) {
    const Index first = count[i * w.of_query], n = count[(i + 1) * w.of_query] - first, a = edges[i];
    if (n == 0) return;
    EdgeEdge* mine = out.p + first;
    sort_strided(&mine->b, kStride<EdgeEdge>, n);
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
  const Walkers w{walkers_};
  const View<const Index> points = std::as_const(points_).view(), edges = std::as_const(edges_).view();
  count_near("broadphase.count_point_triangle", TrianglesNear{s, triangle_tree_.view(), points, y, dy, r}, w, points, point_walkers, pt_counts_,
             pt_noted_);
  count_near("broadphase.count_edge_edge", EdgesNear{s, edge_tree_.view(), edges, y, dy, r}, w, edges, edge_walkers, ee_counts_, ee_noted_);
  device::Fetch fetch;
  out.begin_add_up({pt_counts_, point_walkers, point_env_first_.view()}, {ee_counts_, edge_walkers, edge_env_first_.view()}, sums_, fetch);
  fetch.now("pairs");
  return sums_;
}

void PairSearch::fill(View<const Vec3> y, View<const Vec3> dy, NearPairs& out) {
  const SurfaceView s = surface_.view();
  out.end_add_up(sums_);
  const Walkers w{walkers_};
  const View<const Index> points = std::as_const(points_).view(), edges = std::as_const(edges_).view();
  const View<const Index> pt_count = std::as_const(pt_counts_).view(), ee_count = std::as_const(ee_counts_).view();
  if (const View<PointTriangle> pairs = out.point_triangles.view(); pairs.n > 0) {
    fill_near("broadphase.fill_point_triangle", TrianglesNear{s, triangle_tree_.view(), points, y, dy, asked_}, w, points, pt_count,
              std::as_const(pt_noted_).view(), &pairs.p->triangle, kStride<PointTriangle>);
    complete(s, w, points, pt_count, pairs);
  }
  if (const View<EdgeEdge> pairs = out.edge_edges.view(); pairs.n > 0) {
    fill_near("broadphase.fill_edge_edge", EdgesNear{s, edge_tree_.view(), edges, y, dy, asked_}, w, edges, ee_count, std::as_const(ee_noted_).view(),
              &pairs.p->b, kStride<EdgeEdge>);
    complete(s, w, edges, ee_count, pairs);
  }
}

}  // namespace mortise::geometry
