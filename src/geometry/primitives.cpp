#include "geometry/primitives.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "geometry/topology.h"

namespace mortise::geometry {
namespace {

using Cell = std::array<Index, 3>;

// A length that is a whole odd number of edges up to rounding goes to the larger even number.
Index cells_along(double length, double edge_length) {
  constexpr double kSingle = 1.5, kRounding = 1e-9;
  const double n = length < (kSingle - kRounding) * edge_length ? 1 : 2 * std::round(0.5 * length / edge_length + kRounding);
  if (!(n < 2048))
    throw Error(
        Exit::scene,
        (std::ostringstream() << "edge_length " << edge_length << " m is too small for a length of " << length << " m: more than 2047 cells").str());
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

Index id(const Cell& n, const Cell& c) { return c[0] + (n[0] + 1) * (c[1] + (n[1] + 1) * c[2]); }

template <class Visit>
void for_each(const Cell& count, const Visit& visit) {
  for (Index k = 0; k < count[2]; ++k)
    for (Index j = 0; j < count[1]; ++j)
      for (Index i = 0; i < count[0]; ++i) visit(Cell{i, j, k});
}

std::size_t vertices(const Cell& n) {
  const double count = (n[0] + 1.0) * (n[1] + 1.0) * (n[2] + 1.0);
  if (count > 2e7) throw Error(Exit::scene, "edge_length is too small: the mesh would have more than 20 million vertices");
  return static_cast<std::size_t>(count);
}

// The six tetrahedra of a cell that share its diagonal (Kuhn), mirrored along axes as is_mirrored() says. What two neighbours have in common is split
// by the axes within it, which agree.
std::array<Tet, 6> split(const Cell& n, const Cell& cell) {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};  // even, then odd
  Cell start = cell, step;
  bool flip = false;
  for (int a = 0; a < 3; ++a) {
    const bool mirrored = is_mirrored(cell[a], n[a]);
    step[a] = mirrored ? -1 : 1;
    if (mirrored) ++start[a];
    flip ^= mirrored;
  }
  std::array<Tet, 6> out;
  for (int o = 0; o < 6; ++o) {
    Tet& tet = out[o];
    Cell at = start;
    tet.v[0] = id(n, at);
    for (int s = 0; s < 3; ++s) {
      const int axis = kOrders[o][s];
      at[axis] += step[axis];
      tet.v[s + 1] = id(n, at);
    }
    if ((o >= 3) != flip) std::swap(tet.v[1], tet.v[2]);
  }
  return out;
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

TetMesh solid(const Grid& grid) {
  const Cell& n = grid.n;
  TetMesh mesh;
  mesh.points.reserve(vertices(n));
  mesh.tets.reserve(6ull * n[0] * n[1] * n[2]);
  for_each({n[0] + 1, n[1] + 1, n[2] + 1}, [&](const Cell& c) { mesh.points.push_back(grid.place(c)); });
  for_each(n, [&](const Cell& cell) {
    for (const Tet& t : split(n, cell)) mesh.tets.push_back(t);
  });
  return mesh;
}

TriMesh skin(const Grid& grid) {
  const Cell& n = grid.n;
  std::vector<Index> number(vertices(n), -1);  // of the grid's vertices, on the skin
  TetMesh shell;                               // the outermost cells: they have an inner side too
  for_each(n, [&](const Cell& c) {
    bool outermost = false;
    for (int a = 0; a < 3; ++a) outermost |= c[a] == 0 || c[a] == n[a] - 1;
    if (!outermost) return;
    for (const Tet& t : split(n, c)) shell.tets.push_back(t);
  });
  const auto cell_of = [&](Index v) { return Cell{v % (n[0] + 1), v / (n[0] + 1) % (n[1] + 1), v / (n[0] + 1) / (n[1] + 1)}; };
  const auto outside = [&](const Triangle& t) {
    const Cell c[3] = {cell_of(t.v[0]), cell_of(t.v[1]), cell_of(t.v[2])};
    for (int a = 0; a < 3; ++a)
      if (c[0][a] == c[1][a] && c[1][a] == c[2][a] && (c[0][a] == 0 || c[0][a] == n[a])) return true;
    return false;
  };
  TriMesh out;
  for (const Triangle& t : boundary_triangles(shell)) {
    if (!outside(t)) continue;
    out.triangles.push_back(t);
    for (Index v : t.v) number[v] = 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<Index>(out.points.size());
    out.points.push_back(grid.place(cell_of(static_cast<Index>(v))));
  }
  for (Triangle& t : out.triangles)
    for (Index& v : t.v) v = number[v];
  return out;
}

Grid box_grid(const Vec3& size, const std::array<Index, 3>& n) {
  for (int a = 0; a < 3; ++a) require_positive(size[a], "box: size"), require_positive(n[a], "box: number of cells");
  // (2i - n)/(2n): mirror images get the same bits.
  return {n, [=](const Cell& c) {
            return Vec3(size[0] * (2 * c[0] - n[0]) / (2.0 * n[0]), size[1] * (2 * c[1] - n[1]) / (2.0 * n[1]),
                        size[2] * (2 * c[2] - n[2]) / (2.0 * n[2]));
          }};
}

Grid box_grid(const Vec3& size, double edge_length, Index single) {
  require_positive(edge_length, "box: edge_length");
  for (int a = 0; a < 3; ++a) require_positive(size[a], "box: size");
  std::array<Index, 3> cells;
  for (int k = 0; k < 3; ++k) {
    const Index n = cells_along(size[k], edge_length);
    cells[k] = n == 1 ? single : n;
  }
  return box_grid(size, cells);
}

Grid sphere_grid(double radius, double edge_length) {
  require_positive(radius, "sphere: radius"), require_positive(edge_length, "sphere: edge_length");
  const Index m = cells_of_half(radius, edge_length);
  return {{2 * m, 2 * m, 2 * m}, [=](const Cell& c) { return Vec3(radius / m * to_ball(Vec3(c[0] - m, c[1] - m, c[2] - m))); }};
}

Grid cylinder_grid(double radius, double height, double edge_length) {
  require_positive(radius, "cylinder: radius"), require_positive(height, "cylinder: height");
  require_positive(edge_length, "cylinder: edge_length");
  const Index m = cells_of_half(radius, edge_length), layers = cells_along(height, edge_length);
  return {{2 * m, 2 * m, layers}, [=](const Cell& c) {
            Vec3 p = radius / m * to_ball(Vec3(c[0] - m, c[1] - m, 0));
            p[2] = height * (2 * c[2] - layers) / (2.0 * layers);
            return p;
          }};
}

Grid capsule_grid(double radius, double height, double edge_length) {
  require_positive(radius, "capsule: radius"), require_positive(height, "capsule: height");
  require_positive(edge_length, "capsule: edge_length");
  const Index m = cells_of_half(radius, edge_length), layers = cells_along(height, edge_length);
  return {{2 * m, 2 * m, 2 * m + layers}, [=](const Cell& c) {
            const Index below = std::min(c[2] - m, 0), above = std::max(c[2] - m - layers, 0), between = std::clamp(c[2] - m, 0, layers);
            Vec3 p = radius / m * to_ball(Vec3(c[0] - m, c[1] - m, below + above));
            p[2] += height * (2 * between - layers) / (2.0 * layers);
            return p;
          }};
}

TetMesh box(const Vec3& size, double edge_length) { return solid(box_grid(size, edge_length)); }
TetMesh box(const Vec3& size, const std::array<Index, 3>& cells) { return solid(box_grid(size, cells)); }
TetMesh sphere(double radius, double edge_length) { return solid(sphere_grid(radius, edge_length)); }
TetMesh cylinder(double radius, double height, double edge_length) { return solid(cylinder_grid(radius, height, edge_length)); }
TetMesh capsule(double radius, double height, double edge_length) { return solid(capsule_grid(radius, height, edge_length)); }

}  // namespace mortise::geometry
