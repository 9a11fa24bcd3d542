#pragma once
// Point-triangle and edge-edge pairs, in canonical order: by environment, then by the two ids.
#include <cmath>
#include <vector>

#include "device/device.h"
#include "geometry/collide/distance.h"
#include "geometry/collide/tuning.h"
#include "geometry/surface.h"

namespace mortise::geometry {

struct PointTriangle {
  Index point, triangle;  // point id; index into surface.triangles
  Index v[4];             // points {p, t0, t1, t2}
};
struct EdgeEdge {
  Index a, b;  // indices into surface.edges, a < b
  Index v[4];  // points {a0, a1, b0, b1}
};

struct NearPairs {
  device::Buffer<PointTriangle> point_triangles;
  device::Buffer<EdgeEdge> edge_edges;
  // Pairs of environment e are [offset[e], offset[e+1]).
  std::vector<Index> pt_env_offset, ee_env_offset;
  device::Buffer<Index> pt_env_first, ee_env_first;  // the same where kernels can read it

  // How many pairs every query has (one more than there are queries, for their sum); `first`: first query of every environment.
  struct Counts {
    device::Buffer<Index>& of;
    device::Ranges queries;
    device::View<const Index> first;
  };
  // Turns counts into offsets of their first pairs, and makes room for all. Throws Error(Exit::device) when there are more pairs than can be counted.
  void add_up(const Counts& points, const Counts& edges);
  // The same in two halves, between which `fetch` brings the numbers.
  struct Sums {
    std::vector<double> pt, ee;  // of every environment, exact
    double of(std::size_t env) const { return pt[env] + ee[env]; }
  };
  void begin_add_up(const Counts& points, const Counts& edges, Sums& sums, device::Fetch& fetch);
  void end_add_up(const Sums& sums);
  // Goes on where begin_add_up() of `o` began.
  void take_sizes(NearPairs& o);
  // Makes room for so many pairs of every environment.
  void resize(std::vector<Index> pt_offset, std::vector<Index> ee_offset);
  void copy_from(const NearPairs& o);
};

// Pairs of a list, of which only those are meant that were chosen: i where at[i + 1] > at[i], or all where `at` is empty.
template <class Pair>
struct Chosen {
  device::View<const Pair> pair;
  device::View<const Index> at{};
  MORTISE_HD bool has(Index i) const { return at.n == 0 || at[i + 1] > at[i]; }
};
struct ChosenPairs {
  Chosen<PointTriangle> points;
  Chosen<EdgeEdge> edges;
  device::Ranges of_points{}, of_edges{};  // the lists' parts, by environment
};

// Of the environments of `whose` the pairs of `some`, of the others those of `most`. Throws as add_up().
void join(const SurfaceView& surface, const NearPairs& most, const NearPairs& some, const std::vector<std::uint8_t>& whose, NearPairs& out);

// Two primitives of one body, {p, t0, t1, t2} or {a0, a1, b0, b1} (first: 1 or 2 points), of which the boxes overlap because they are
// neighbours: their distance shrinks by no more than corners of the one move towards corners of the other, and neighbours move nearly alike.
MORTISE_HD inline bool stay_apart(const Index v[4], int first, device::View<const Vec3> y, device::View<const Vec3> dy, double radius) {
  double way2 = 0;
  for (int i = 0; i < first && dy.n > 0; ++i)
    for (int j = first; j < 4; ++j) way2 = std::fmax(way2, (dy[v[i]] - dy[v[j]]).squaredNorm());
  const double least = radius + std::sqrt(way2);
  Vec3 x[4];
  for (int k = 0; k < 4; ++k) x[k] = y[v[k]];
  for (int a = 0; a < 3; ++a) {  // boxes as they stand, which tell most pairs of a body that moves
    const double lo = first == 1 ? x[0][a] : std::fmin(x[0][a], x[1][a]), hi = first == 1 ? x[0][a] : std::fmax(x[0][a], x[1][a]);
    const double lo2 = std::fmin(std::fmin(first == 1 ? x[1][a] : x[2][a], x[2][a]), x[3][a]),
                 hi2 = std::fmax(std::fmax(first == 1 ? x[1][a] : x[2][a], x[2][a]), x[3][a]);
    if (std::fmax(lo2 - hi, lo - hi2) * (1 - tuning::kApart) > least) return true;
  }
  // And along the way between their middles.
  const Vec3 middle = first == 1 ? x[0] : Vec3(0.5 * (x[0] + x[1])),
             way = (first == 1 ? Vec3((x[1] + x[2] + x[3]) / 3) : Vec3(0.5 * (x[2] + x[3]))) - middle;
  const auto along = [&](const Vec3& point) { return (point - middle).dot(way); };
  const double far = first == 1 ? along(x[0]) : std::fmax(along(x[0]), along(x[1])),
               near = std::fmin(first == 1 ? std::fmin(along(x[1]), along(x[2])) : along(x[2]), along(x[3]));
  if ((near - far) * (1 - tuning::kApart) > least * way.norm()) return true;
  const double distance = std::sqrt(first == 1 ? closest_point_triangle(x).squared : closest_edge_edge(x).squared);
  return distance * (1 - tuning::kApart) > least;
}

}  // namespace mortise::geometry
