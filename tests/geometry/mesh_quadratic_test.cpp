#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "geometry/io/msh.h"
#include "geometry/io/read.h"
#include "geometry/midsides.h"
#include "geometry/primitives.h"
#include "geometry/quadratic.h"
#include "geometry/shapes.h"
#include "geometry/tet_rule.h"
#include "geometry/topology.h"
#include "geometry/triangle_rule.h"
#include "mesh_helpers.h"

namespace mortise::geometry {
namespace {

// Barycentrics of the nodes of a tetrahedron.
void node_place(int node, double l[4]) {
  for (int k = 0; k < 4; ++k) l[k] = 0;
  if (node < 4) {
    l[node] = 1;
  } else {
    l[edge_begin(node - 4)] = l[edge_end(node - 4)] = 0.5;
  }
}

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

TEST(QuadraticShapes, AreOneAtTheirNodeAndZeroAtTheOthers) {
  for (int a = 0; a < 10; ++a)
    for (int b = 0; b < 10; ++b) {
      double l[4];
      node_place(b, l);
      EXPECT_EQ(tet_shape_function(a, l), a == b ? 1 : 0);
    }
  for (int b = 0; b < 6; ++b) {
    double l[4], N[6];
    node_place(b < 3 ? b : b + 1, l);  // edge e of the triangle is edge e of the tetrahedron
    triangle_shape(l, N);
    for (int a = 0; a < 6; ++a) EXPECT_EQ(N[a], a == b ? 1 : 0);
  }
}

TEST(QuadraticShapes, SlopesAreDerivatives) {
  const double at[3] = {0.2, 0.35, 0.15}, h = 1e-3;  // central differences are exact for quadratics
  for (int a = 0; a < 10; ++a)
    for (int k = 0; k < 3; ++k) {
      const auto value = [&](double s) {
        double x[3] = {at[0], at[1], at[2]};
        x[k] += s;
        const double l[4] = {1 - x[0] - x[1] - x[2], x[0], x[1], x[2]};
        return tet_shape_function(a, l);
      };
      const double l[4] = {1 - at[0] - at[1] - at[2], at[0], at[1], at[2]};
      EXPECT_NEAR(tet_slope(a, l)[k], (value(h) - value(-h)) / (2 * h), 1e-12);
    }
  for (int k = 0; k < 2; ++k) {
    const auto value = [&](double s, double N[6]) {
      double x[2] = {at[0], at[1]};
      x[k] += s;
      const double l[3] = {1 - x[0] - x[1], x[0], x[1]};
      triangle_shape(l, N);
    };
    double up[6], down[6], d[2][6];
    const double l[3] = {1 - at[0] - at[1], at[0], at[1]};
    value(h, up), value(-h, down), triangle_slope(l, d[0], d[1]);
    for (int a = 0; a < 6; ++a) EXPECT_NEAR(d[k][a], (up[a] - down[a]) / (2 * h), 1e-12);
  }
}

TEST(QuadraticShapes, QuartersCoverTheTriangle) {
  for (int q = 0; q < 4; ++q)
    for (int k = 0; k < 3; ++k) {
      double n[3] = {0, 0, 0}, l[3], N[6];
      n[k] = 1;
      quarter_place(q, n, l);
      triangle_shape(l, N);
      EXPECT_EQ(N[quarter_node(q, k)], 1);
    }
}

// int l1^a l2^b l3^c dV / V = 6 a! b! c! / (a + b + c + 3)!
TEST(QuadraticShapes, RulesAreExactToTheirDegree) {
  const auto exact = [](int a, int b, int c) { return 6 * factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3); };
  for (int a = 0; a <= 5; ++a)
    for (int b = 0; a + b <= 5; ++b)
      for (int c = 0; a + b + c <= 5; ++c) {
        double sum = 0, four = 0;
        for (const TetRulePoint& p : tet_rule_5()) sum += p.weight * std::pow(p.l[1], a) * std::pow(p.l[2], b) * std::pow(p.l[3], c);
        for (int p = 0; p < kTetPoints; ++p) {
          double l[4];
          tet_point(p, l);
          four += 0.25 * std::pow(l[1], a) * std::pow(l[2], b) * std::pow(l[3], c);
        }
        EXPECT_NEAR(sum, exact(a, b, c), 1e-15) << a << b << c;
        if (a + b + c <= 2) {
          EXPECT_NEAR(four, exact(a, b, c), 1e-15) << a << b << c;
        }
      }
}

TEST(Midsides, OneNodeInTheMiddleOfEveryEdge) {
  const TetMesh linear = box({1, 2, 3}, 1.0), m = with_midsides(linear);
  std::set<std::pair<Index, Index>> edges;
  for (const Tet& t : linear.tets)
    for (int e = 0; e < 6; ++e) edges.insert(std::minmax(t.v[edge_begin(e)], t.v[edge_end(e)]));
  ASSERT_EQ(m.points.size(), linear.points.size() + edges.size());
  std::size_t i = linear.points.size();
  for (const auto& [a, b] : edges) EXPECT_EQ(m.points[i++], Vec3(0.5 * (linear.points[a] + linear.points[b])));
  for (std::size_t t = 0; t < m.tets.size(); ++t)
    for (int e = 0; e < 6; ++e)
      EXPECT_EQ(m.points[m.midsides[t].v[e]], Vec3(0.5 * (m.points[m.tets[t].v[edge_begin(e)]] + m.points[m.tets[t].v[edge_end(e)]])));

  const std::vector<Face> faces = boundary_faces(m);
  TriMesh fine{m.points, quarters(faces)};
  EXPECT_EQ(fine.triangles.size(), 4 * boundary_triangles(linear).size());
  EXPECT_NEAR(area(fine), 22, 1e-13);
  EXPECT_NEAR(mass_properties(fine).volume, 6, 1e-13);  // closed and outward
}

Params round(const std::string& kind, double height = 0) {
  Params p = Params::make_table(), s = Params::make_table();
  p.set("radius", Params::make_number(2)), p.set("edge_length", Params::make_number(1));
  if (height > 0) p.set("height", Params::make_number(height));
  s.set(kind, p);
  return s;
}

double quadratic_volume(const TetMesh& m) {
  double sum = 0;
  for (std::size_t t = 0; t < m.tets.size(); ++t)
    for (const TetRulePoint& p : tet_rule_5()) {
      Mat3 J = Mat3::Zero();
      for (int a = 0; a < 10; ++a) J += m.points[a < 4 ? m.tets[t].v[a] : m.midsides[t].v[a - 4]] * tet_slope(a, p.l).transpose();
      EXPECT_GT(J.determinant(), 0);
      sum += p.weight * J.determinant() / 6;
    }
  return sum;
}

TEST(Midsides, CurvedEdgesFollowTheSurface) {
  const double pi = std::acos(-1.0);
  const struct {
    Params shape;
    double volume;
  } cases[] = {{round("sphere"), 4.0 / 3 * pi * 8}, {round("cylinder", 3), pi * 4 * 3}, {round("capsule", 3), pi * 4 * 3 + 4.0 / 3 * pi * 8}};
  for (const auto& c : cases) {
    const TetMesh straight = tet_shape(c.shape, {2, false}), curved = tet_shape(c.shape, {2, true});
    const double off = std::abs(quadratic_volume(straight) / c.volume - 1), near = std::abs(quadratic_volume(curved) / c.volume - 1);
    EXPECT_GT(off, 0.02);
    EXPECT_LT(near, 0.1 * off);
    EXPECT_NEAR(quadratic_volume(straight), volume(straight), 1e-12);
  }
  const TetMesh ball = tet_shape(round("sphere"), {2, true});
  for (const Face& f : boundary_faces(ball))
    for (Index v : f.v) EXPECT_NEAR(ball.points[v].norm(), 2, 1e-12);
}

TEST(Midsides, RefusesWhatMakesNoSense) {
  Params box_shape = Params::make_table({"scene.yaml", 7, 5}), p = Params::make_table({"scene.yaml", 7, 5});
  p.set("edge_length", Params::make_number(1));
  p.set("size", Params::make_list({Params::make_number(1), Params::make_number(1), Params::make_number(1)}));
  box_shape.set("box", p);
  expect_error([&] { tet_shape(box_shape, {2, true}); }, Exit::scene, {"scene.yaml:7:5", "curved edges need"});
  expect_error([&] { tet_shape(round("sphere"), {1, true}); }, Exit::scene, {"order: 2"});
}

TEST(Midsides, SecondOrderFilesKeepTheirNodes) {
  const TempFolder folder;
  const TetMesh m = tet_shape(round("sphere"), {2, true});
  write_msh(folder.file("ball.msh"), m);
  const TetMesh back = read_tets(folder.file("ball.msh"));
  ASSERT_EQ(back.points.size(), m.points.size());
  EXPECT_NEAR(quadratic_volume(back), quadratic_volume(m), 1e-13);
  for (std::size_t t = 0; t < m.tets.size(); ++t)
    for (int e = 0; e < 6; ++e) EXPECT_EQ(back.points[back.midsides[t].v[e]], m.points[m.midsides[t].v[e]]);

  Params p = Params::make_table(), s = Params::make_table();
  p.set("file", Params::make_text(folder.file("ball.msh"))), p.set("scale", Params::make_number(1)), p.set("weld", Params::make_number(0));
  s.set("mesh", p);
  EXPECT_TRUE(tet_shape(s, {2, false}).quadratic());
  expect_error([&] { tet_shape(s); }, Exit::scene, {"second order", "order: 2"});
}

}  // namespace
}  // namespace mortise::geometry
