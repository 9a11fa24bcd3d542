#pragma once
// Random triangle soups and their surfaces.
#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

#include "geometry/surface.h"

namespace mortise::geometry::test {

template <class T>
std::vector<T> download(device::View<const T> v) {
  std::vector<T> host(v.n);
  if (v.n > 0) device::copy_out(host.data(), v.p, host.size() * sizeof(T));
  return host;
}

struct Soup {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<Edge> edges;
  std::vector<Index> body, env;
  Index bodies = 0;
  std::vector<std::uint8_t> allowed;

  void add_body(const std::vector<Vec3>& p, const std::vector<Triangle>& t, Index in_env) {
    const Index base = static_cast<Index>(points.size());
    points.insert(points.end(), p.begin(), p.end());
    std::set<std::array<Index, 2>> unique;
    for (const Triangle& tri : t) {
      triangles.push_back({{tri.v[0] + base, tri.v[1] + base, tri.v[2] + base}});
      for (int k = 0; k < 3; ++k) {
        const Index a = tri.v[k] + base, b = tri.v[(k + 1) % 3] + base;
        unique.insert({std::min(a, b), std::max(a, b)});
      }
    }
    for (const auto& e : unique) edges.push_back({{e[0], e[1]}});
    body.insert(body.end(), p.size(), bodies++);
    env.insert(env.end(), p.size(), in_env);
  }

  Surface surface() const {
    Surface s;
    std::vector<Index> vertices(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) vertices[i] = static_cast<Index>(i);
    s.vertices.upload(vertices);
    s.body.upload(body);
    s.env.upload(env);
    s.edges.upload(edges);
    s.triangles.upload(triangles);
    s.pair_allowed.upload(allowed);
    s.pairs = geometry::BodyPairs(std::vector<Index>(bodies, 0));  // a column for every body, as environments may be mixed here
    return s;
  }
};

using Random = std::mt19937_64;
inline double uniform(Random& r, double lo, double hi) { return lo + (hi - lo) * static_cast<double>(r() >> 11) * 0x1p-53; }
inline Vec3 random_vec(Random& r, double half) {
  const double x = uniform(r, -half, half), y = uniform(r, -half, half);
  return {x, y, uniform(r, -half, half)};
}

// A patch of n x n squares with rough heights around `centre`.
inline void add_patch(Soup& soup, Random& r, int n, double size, const Vec3& centre, Index env) {
  std::vector<Vec3> p;
  std::vector<Triangle> t;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) p.push_back(centre + Vec3(size * i / n - size / 2, size * j / n - size / 2, uniform(r, -0.3, 0.3) * size / n));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Index a = i * (n + 1) + j, b = a + n + 1;
      t.push_back({{a, b, a + 1}});
      t.push_back({{b, b + 1, a + 1}});
    }
  soup.add_body(p, t, env);
}

}  // namespace mortise::geometry::test
