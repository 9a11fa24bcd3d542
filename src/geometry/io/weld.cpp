#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "base/error.h"
#include "geometry/io/read.h"
#include "geometry/topology.h"

namespace mortise::geometry {
namespace {

// Equal positions (0 and -0 are equal; NaN equals nothing): each point -> the first one like it.
std::vector<Index> same_position(const std::vector<Vec3>& points) {
  std::vector<Index> order(points.size()), to(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::iota(to.begin(), to.end(), 0);
  const auto finite_end = std::stable_partition(order.begin(), order.end(), [&](Index i) { return points[i].allFinite(); });
  const auto key = [&](Index i) { return std::array{points[i][0], points[i][1], points[i][2]}; };
  std::sort(order.begin(), finite_end, [&](Index a, Index b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (auto i = order.begin(); i != finite_end; ++i)
    if (i != order.begin() && key(*i) == key(i[-1])) to[*i] = to[i[-1]];
  return to;
}

// Points in order; each joins the first kept point within the tolerance, looked up in a hash grid of that cell size.
std::vector<Index> near_position(const std::vector<Vec3>& points, double tolerance) {
  struct Hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& c) const {
      std::uint64_t h = 1469598103934665603ull;
      for (std::int64_t x : c) h = (h ^ static_cast<std::uint64_t>(x)) * 1099511628211ull, h ^= h >> 29;
      return h;
    }
  };
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<Index>, Hash> grid;
  std::vector<Index> to(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    to[i] = static_cast<Index>(i);
    const Vec3& p = points[i];
    if (!p.allFinite()) continue;
    const Vec3 c = p / tolerance;
    if (c.cwiseAbs().maxCoeff() > 9e15) throw Error(Exit::scene, "'weld' is too small for coordinates of this size");
    std::array<std::int64_t, 3> cell;
    for (int a = 0; a < 3; ++a) cell[a] = static_cast<std::int64_t>(std::floor(c[a]));
    Index kept = -1;
    for (int n = 0; n < 27; ++n) {
      const auto bucket = grid.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (bucket == grid.end()) continue;
      for (Index j : bucket->second)
        if ((points[j] - p).norm() <= tolerance && (kept < 0 || j < kept)) kept = j;
    }
    if (kept >= 0) {
      to[i] = kept;
    } else {
      grid[cell].push_back(static_cast<Index>(i));
    }
  }
  return to;
}

}  // namespace

TriMesh weld(const TriMesh& mesh, double tolerance) {
  if (!(tolerance >= 0)) throw Error(Exit::scene, "weld tolerance must not be negative");
  const std::vector<Index> to = tolerance > 0 ? near_position(mesh.points, tolerance) : same_position(mesh.points);
  TriMesh out;
  out.points = mesh.points;
  for (const Triangle& t : mesh.triangles) {
    const Triangle w{{to[t.v[0]], to[t.v[1]], to[t.v[2]]}};
    if (w.v[0] != w.v[1] && w.v[1] != w.v[2] && w.v[2] != w.v[0]) out.triangles.push_back(w);
  }
  return without_unused_points(out);
}

}  // namespace mortise::geometry
