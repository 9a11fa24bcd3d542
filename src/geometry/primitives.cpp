#include "geometry/primitives.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace mortise::geometry {
namespace {

using Cell = std::array<Index, 3>;

// A length that is a whole odd number of edges up to rounding goes to the larger even number.
Index cells_along(double length, double edge_length) {
  constexpr double kSingle = 1.5, kRounding = 1e-9;
  const double n = length < (kSingle - kRounding) * edge_length ? 1 : 2 * std::round(0.5 * length / edge_length + kRounding);
  if (!(n < 2048))
    throw Error(Exit::scene, "edge_length " + std::to_string(edge_length) + " m is too small for a length of " + std::to_string(length) +
                                 " m: more than 2047 cells");
  return static_cast<Index>(n);
}
// Of half a body: its other half mirrors it, so that any number does.
Index cells_of_half(double length, double edge_length) { return std::max<Index>(1, cells_along(2 * length, edge_length) / 2); }

void require_positive(double value, const char* what) {
  if (!(value > 0) || !std::isfinite(value)) throw Error(Exit::scene, std::string(what) + " must be a positive number");
}

// Is cell i of the n along an axis split as the mirror image of the Kuhn split, so that its diagonal runs towards lower places? Diagonals run
// outwards in the outermost cells and turn round from every cell to the next inwards.
bool is_mirrored(Index i, Index n) {
  const Index depth = std::min(i, n - 1 - i);
  return (depth % 2 == 1) != (2 * i < n - 1);
}

// Kuhn split of a grid: each cell into the six tetrahedra that share its diagonal, mirrored along axes as is_mirrored() says. What two
// neighbours have in common is split by the axes within it, which agree. `place(i,j,k)` is the position of a grid vertex.
template <class Place>
TetMesh kuhn_grid(const Cell& n, const Place& place) {
  TetMesh mesh;
  const double count = (n[0] + 1.0) * (n[1] + 1.0) * (n[2] + 1.0);
  if (count > 2e7) throw Error(Exit::scene, "edge_length is too small: the mesh would have more than 20 million vertices");
  mesh.points.reserve(static_cast<std::size_t>(count));
  mesh.tets.reserve(6ull * n[0] * n[1] * n[2]);
  for (Index k = 0; k <= n[2]; ++k)
    for (Index j = 0; j <= n[1]; ++j)
      for (Index i = 0; i <= n[0]; ++i) mesh.points.push_back(place(i, j, k));
  const auto id = [&](const Cell& c) { return c[0] + (n[0] + 1) * (c[1] + (n[1] + 1) * c[2]); };

  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};  // even, then odd
  for (Index k = 0; k < n[2]; ++k)
    for (Index j = 0; j < n[1]; ++j)
      for (Index i = 0; i < n[0]; ++i) {
        const Cell cell{i, j, k};
        Cell start = cell, step;
        bool flip = false;
        for (int a = 0; a < 3; ++a) {
          const bool mirrored = is_mirrored(cell[a], n[a]);
          step[a] = mirrored ? -1 : 1;
          if (mirrored) ++start[a];
          flip ^= mirrored;
        }
        for (int o = 0; o < 6; ++o) {
          Tet tet;
          Cell at = start;
          tet.v[0] = id(at);
          for (int s = 0; s < 3; ++s) {
            const int axis = kOrders[o][s];
            at[axis] += step[axis];
            tet.v[s + 1] = id(at);
          }
          if ((o >= 3) != flip) std::swap(tet.v[1], tet.v[2]);
          mesh.tets.push_back(tet);
        }
      }
  return mesh;
}

// Direction of the point c of a cube surface |c|_inf = s, spaced by equal angles along each face ("equiangular cubed
// sphere"): c/s -> (tan(pi/4 c/s)) / |...|. Works for the square in the plane too (c_z = 0).
Vec3 direction(const Vec3& c, double s) {
  const Vec3 t((c / s).unaryExpr([](double x) { return std::tan(M_PI / 4 * x); }));
  return t.normalized();
}

// Cube [-m,m]^3 -> ball of radius m: shells |c|_inf = s become spheres of radius s. Cells along the edges and corners of the
// cube open to flat angles there; their diagonal ends in that edge, so no tetrahedron has two faces on the sphere.
Vec3 to_ball(const Vec3& c) {
  const double s = c.cwiseAbs().maxCoeff();
  return s == 0 ? Vec3(Vec3::Zero()) : Vec3(s * direction(c, s));
}

}  // namespace

TetMesh box(const Vec3& size, double edge_length) {
  require_positive(edge_length, "box: edge_length");
  for (int a = 0; a < 3; ++a) require_positive(size[a], "box: size");
  return box(size, {cells_along(size[0], edge_length), cells_along(size[1], edge_length), cells_along(size[2], edge_length)});
}

TetMesh box(const Vec3& size, const std::array<Index, 3>& cells) {
  for (int a = 0; a < 3; ++a) require_positive(size[a], "box: size"), require_positive(cells[a], "box: number of cells");
  return kuhn_grid(cells, [&](Index i, Index j, Index k) {
    // (2i - n)/(2n): mirror images get the same bits.
    return Vec3(size[0] * (2 * i - cells[0]) / (2.0 * cells[0]), size[1] * (2 * j - cells[1]) / (2.0 * cells[1]),
                size[2] * (2 * k - cells[2]) / (2.0 * cells[2]));
  });
}

TetMesh sphere(double radius, double edge_length) {
  require_positive(radius, "sphere: radius"), require_positive(edge_length, "sphere: edge_length");
  const Index m = cells_of_half(radius, edge_length);
  return kuhn_grid({2 * m, 2 * m, 2 * m}, [&](Index i, Index j, Index k) { return Vec3(radius / m * to_ball(Vec3(i - m, j - m, k - m))); });
}

TetMesh cylinder(double radius, double height, double edge_length) {
  require_positive(radius, "cylinder: radius"), require_positive(height, "cylinder: height");
  require_positive(edge_length, "cylinder: edge_length");
  const Index m = cells_of_half(radius, edge_length), layers = cells_along(height, edge_length);
  return kuhn_grid({2 * m, 2 * m, layers}, [&](Index i, Index j, Index k) {
    Vec3 p = radius / m * to_ball(Vec3(i - m, j - m, 0));
    p[2] = height * (2 * k - layers) / (2.0 * layers);
    return p;
  });
}

TetMesh capsule(double radius, double height, double edge_length) {
  require_positive(radius, "capsule: radius"), require_positive(height, "capsule: height");
  require_positive(edge_length, "capsule: edge_length");
  const Index m = cells_of_half(radius, edge_length), layers = cells_along(height, edge_length);
  return kuhn_grid({2 * m, 2 * m, 2 * m + layers}, [&](Index i, Index j, Index k) {
    const Index below = std::min(k - m, 0), above = std::max(k - m - layers, 0), between = std::clamp(k - m, 0, layers);
    Vec3 p = radius / m * to_ball(Vec3(i - m, j - m, below + above));
    p[2] += height * (2 * between - layers) / (2.0 * layers);
    return p;
  });
}

}  // namespace mortise::geometry
