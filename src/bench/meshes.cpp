#include "bench/meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "base/error.h"

namespace mortise::bench {
namespace {

using Grid = std::array<std::size_t, 3>;  // nodes along every axis

// Six tetrahedra per cell around a diagonal, neighbours mirrored, so that the mesh is symmetric about its grid planes. In the first
// cell of an axis the diagonal starts at the corner `first` (0 or 1). The first axis runs fastest in `points`.
std::vector<Tet> split(const Grid& n, const std::array<std::size_t, 3>& first) {
  constexpr int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<Tet> tets;
  for (std::size_t k = 0; k + 1 < n[2]; ++k)
    for (std::size_t j = 0; j + 1 < n[1]; ++j)
      for (std::size_t i = 0; i + 1 < n[0]; ++i)
        for (int o = 0; o < 6; ++o) {
          const std::array<int, 3> from{static_cast<int>((i + first[0]) % 2), static_cast<int>((j + first[1]) % 2),
                                        static_cast<int>((k + first[2]) % 2)};
          const bool mirrored = (from[0] + from[1] + from[2]) % 2;
          std::array<int, 3> at = from;
          Tet t;
          for (int v = 0; v < 4; ++v) {
            if (v > 0) at[order[o][v - 1]] = 1 - from[order[o][v - 1]];
            t.v[v] = static_cast<Index>(i + at[0] + n[0] * (j + at[1] + n[1] * (k + at[2])));
          }
          const bool odd = o == 1 || o == 2 || o == 5;  // permutation of the axes
          if (odd != mirrored) std::swap(t.v[2], t.v[3]);
          tets.push_back(t);
        }
  return tets;
}

}  // namespace

std::vector<double> graded(double h, int fine, int coarse, double end) {
  std::vector<double> x{0};
  if (coarse == 0) h = end / fine;
  for (int i = 1; i <= fine; ++i) x.push_back(h * i);
  if (coarse == 0) return x;
  // h (q + q^2 + ... + q^coarse) = end - h fine
  const double wanted = end / h - fine;
  double lo = 1e-3, hi = 1e3;
  for (int it = 0; it < 200; ++it) {
    const double q = std::sqrt(lo * hi);
    double sum = 0;
    for (int i = 1; i <= coarse; ++i) sum += std::pow(q, i);
    (sum < wanted ? lo : hi) = q;
  }
  const double q = std::sqrt(lo * hi);
  for (int i = 1; i <= coarse; ++i) x.push_back(x.back() + h * std::pow(q, i));
  x.back() = end;
  return x;
}

std::vector<double> mirrored(std::vector<double> z) {
  std::reverse(z.begin(), z.end());
  for (double& c : z) c = -c;
  return z;
}

std::vector<double> from_one(std::vector<double> t) {
  for (double& c : t) c = 1 - c;
  std::reverse(t.begin(), t.end());
  return t;
}

geometry::TetMesh grid_block(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z) {
  geometry::TetMesh mesh;
  for (double c : z)
    for (double b : y)
      for (double a : x) mesh.points.push_back({a, b, c});
  mesh.tets = split({x.size(), y.size(), z.size()}, {0, 0, 0});
  return mesh;
}

geometry::TetMesh jittered_block(const Vec3& lo, const Vec3& hi, const std::array<int, 3>& cells, double jitter, std::uint32_t seed) {
  std::vector<double> planes[3];
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < cells[a]; ++i) planes[a].push_back(lo[a] + (hi[a] - lo[a]) * i / cells[a]);
    planes[a].push_back(hi[a]);
  }
  geometry::TetMesh mesh = grid_block(planes[0], planes[1], planes[2]);
  std::mt19937 random(seed);
  for (Vec3& x : mesh.points)
    for (int a = 0; a < 3; ++a) {
      const double u = 2 * (static_cast<double>(random()) / 4294967295.0) - 1;  // the same everywhere, unlike std distributions
      if (x[a] > lo[a] && x[a] < hi[a]) x[a] += jitter * u * (hi[a] - lo[a]) / cells[a];
    }
  return mesh;
}

geometry::TetMesh ball_octant(double radius, const std::vector<double>& s, const std::vector<double>& t) {
  geometry::TetMesh mesh;
  for (auto w = t.rbegin(); w != t.rend(); ++w)  // from the pole up
    for (double v : s)
      for (double u : s) {
        // The cube [-1, 1]^3 onto the ball: x sqrt(1 - y^2/2 - z^2/2 + y^2 z^2/3) and cyclic; its faces onto the sphere.
        const double uu = u * u, vv = v * v, ww = *w * *w;
        mesh.points.push_back(radius * Vec3(u * std::sqrt(1 - vv / 2 - ww / 2 + vv * ww / 3), v * std::sqrt(1 - ww / 2 - uu / 2 + ww * uu / 3),
                                            -*w * std::sqrt(1 - uu / 2 - vv / 2 + uu * vv / 3)));
      }
  // Diagonals run from the edges of the cube inwards: at an edge two faces of a cell lie on the sphere, and a diagonal along it
  // would leave tetrahedra with all four vertices there.
  const std::size_t first = s.size() % 2 ? 0 : 1;  // the last cell's diagonal starts at its outer corner
  mesh.tets = split({s.size(), s.size(), t.size()}, {first, first, 0});
  return mesh;
}

geometry::TetMesh ball_octant(double radius, const Spot& at_pole) {
  return ball_octant(radius, graded(std::sqrt(2.0) * at_pole.h / radius, at_pole.fine, at_pole.out, 1),
                     from_one(graded(at_pole.h / radius, 2, at_pole.down, 1)));
}

geometry::TetMesh cylinder_quarter(double radius, const std::vector<double>& s, const std::vector<double>& t, const std::vector<double>& y) {
  geometry::TetMesh mesh;
  for (auto w = t.rbegin(); w != t.rend(); ++w)
    for (double v : y)
      for (double u : s)
        mesh.points.push_back({radius * u * std::sqrt(1 - *w * *w / 2), v, -radius * *w * std::sqrt(1 - u * u / 2)});  // square onto disc
  mesh.tets = split({s.size(), y.size(), t.size()}, {s.size() % 2 ? 0u : 1u, 0, 0});  // diagonals from the edge of the square inwards
  return mesh;
}

geometry::TetMesh cylinder_quarter(double radius, const Spot& at_line, const std::vector<double>& y) {
  return cylinder_quarter(radius, graded(std::sqrt(2.0) * at_line.h / radius, at_line.fine, at_line.out, 1),
                          from_one(graded(at_line.h / radius, 2, at_line.down, 1)), y);
}

geometry::TetMesh ring_sector(const std::vector<double>& r, const std::vector<double>& angles, const std::vector<double>& z) {
  geometry::TetMesh mesh;
  // Exactly on the axes, where symmetry planes select nodes.
  const auto exact = [](double v) { return std::abs(v) < 1e-15 ? 0 : v; };
  for (double height : z)
    for (double angle : angles)
      for (double radius : r) mesh.points.push_back({radius * exact(std::cos(angle)), radius * exact(std::sin(angle)), height});
  mesh.tets = split({r.size(), angles.size(), z.size()}, {0, 0, 0});
  return mesh;
}

geometry::TetMesh ring_quarter(const std::vector<double>& r, int cells, const std::vector<double>& z) {
  return ring_sector(r, graded(0, cells, 0, 0.5 * std::numbers::pi), z);
}

geometry::TetMesh split_to(geometry::TetMesh mesh, std::size_t vertices, std::size_t tets) {
  while (mesh.points.size() < vertices) {
    std::map<std::pair<Index, Index>, std::vector<std::size_t>> around;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < i; ++j) around[std::minmax(mesh.tets[t].v[i], mesh.tets[t].v[j])].push_back(t);
    const std::size_t left = vertices - mesh.points.size(), wanted = (tets - mesh.tets.size() + left / 2) / left;
    const std::pair<const std::pair<Index, Index>, std::vector<std::size_t>>* best = nullptr;
    const auto off = [&](const auto& edge) { return std::abs(static_cast<double>(edge.second.size()) - static_cast<double>(wanted)); };
    const auto length = [&](const auto& edge) { return (mesh.points[edge.first.first] - mesh.points[edge.first.second]).norm(); };
    for (const auto& edge : around)
      if (!best || off(edge) < off(*best) || (off(edge) == off(*best) && length(edge) > length(*best) * (1 + 1e-12))) best = &edge;
    const auto [a, b] = best->first;
    const Index middle = static_cast<Index>(mesh.points.size());
    const Vec3 at = 0.5 * (mesh.points[a] + mesh.points[b]);
    mesh.points.push_back(at);
    for (std::size_t t : best->second) {
      Tet half = mesh.tets[t];
      std::replace(mesh.tets[t].v, mesh.tets[t].v + 4, a, middle);
      std::replace(half.v, half.v + 4, b, middle);
      mesh.tets.push_back(half);
    }
  }
  if (mesh.tets.size() != tets) throw Error(Exit::internal, "splitting edges does not lead to " + std::to_string(tets) + " tetrahedra");
  return mesh;
}

geometry::TetMesh upside_down(geometry::TetMesh mesh, double height) {
  for (Vec3& x : mesh.points) x[2] = height - x[2];
  for (Tet& t : mesh.tets) std::swap(t.v[2], t.v[3]);
  return mesh;
}

geometry::TetMesh punch_quarter(double radius, double rise, double height, int sectors) {
  geometry::TetMesh mesh;
  mesh.points = {Vec3(0, 0, 0), Vec3(0, 0, height)};
  for (int k = 0; k <= sectors; ++k) {
    const double angle = 0.5 * std::numbers::pi * k / sectors, x = k == sectors ? 0 : radius * std::cos(angle), y = radius * std::sin(angle);
    mesh.points.push_back({x, y, rise}), mesh.points.push_back({x, y, height});
  }
  for (Index k = 0; k < sectors; ++k) {
    // Prism of the sector: lower face 0 a c, upper face 1 b d.
    const Index a = 2 + 2 * k, b = a + 1, c = a + 2, d = a + 3;
    mesh.tets.push_back({0, a, c, 1}), mesh.tets.push_back({a, c, 1, b}), mesh.tets.push_back({c, 1, b, d});
  }
  for (Tet& t : mesh.tets) {
    const Vec3 o = mesh.points[t.v[0]];
    if ((mesh.points[t.v[1]] - o).cross(mesh.points[t.v[2]] - o).dot(mesh.points[t.v[3]] - o) < 0) std::swap(t.v[2], t.v[3]);
  }
  return mesh;
}

}  // namespace mortise::bench
