// Clipping and quadrature of mortar contact: pieces of a triangle must add up to it, whatever the meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "effects/mortar_contact/clip.h"
#include "effects/mortar_contact/quadrature.h"

using namespace mortise;
using namespace mortise::effects::mortar;

namespace {

using Soup = std::vector<std::array<Vec3, 3>>;

// n x n squares of side 1/n over [0,1]^2 at height z, each in two triangles with normals along `up`; inner nodes jittered.
Soup square(int n, double z, bool up, double jitter, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-jitter / n, jitter / n);
  std::vector<Vec3> x;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const bool inside = i > 0 && j > 0 && i < n && j < n;
      const double dx = u(random), dy = u(random);
      x.push_back({double(i) / n + (inside ? dx : 0), double(j) / n + (inside ? dy : 0), z});
    }
  Soup out;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Vec3 a = x[j * (n + 1) + i], b = x[j * (n + 1) + i + 1], c = x[(j + 1) * (n + 1) + i + 1], d = x[(j + 1) * (n + 1) + i];
      if (up)
        out.push_back({a, b, c}), out.push_back({a, c, d});
      else
        out.push_back({a, c, b}), out.push_back({a, d, c});
    }
  return out;
}

void move(Soup& soup, const Mat3& R, const Vec3& t) {
  for (auto& triangle : soup)
    for (Vec3& x : triangle) x = R * x + t;
}

// Largest |covered share - 1| over the slave triangles.
double partition_defect(const Soup& slaves, const Soup& masters) {
  double worst = 0;
  for (const auto& s : slaves) {
    const SlavePlane plane = slave_plane(s[0], s[1], s[2]);
    double sum = 0;
    for (const auto& m : masters) {
      double L[3][3];
      for (int k = 0; k < 3; ++k) project(plane, m[k], L[k]);
      sum += polygon_area(clip(L));
    }
    worst = std::max(worst, std::abs(sum - 1));
  }
  return worst;
}

// A larger master: scaled about the middle so that it covers the unit square with room to spare.
void grow(Soup& soup, double factor) {
  for (auto& triangle : soup)
    for (Vec3& x : triangle) x = Vec3(0.5 + factor * (x[0] - 0.5), 0.5 + factor * (x[1] - 0.5), x[2]);
}

const Mat3 kTurn = Eigen::AngleAxisd(0.7, Vec3(1, -2, 3).normalized()).toRotationMatrix();

}  // namespace

TEST(MortarClip, CoincidentMeshesPartition) {
  for (double jitter : {0.0, 0.3})
    for (const Mat3& R : {Mat3(Mat3::Identity()), kTurn}) {
      Soup slave = square(4, 0, true, jitter, 1), master = square(4, 0.01, false, jitter, 1);
      move(slave, R, {3, -1, 2}), move(master, R, {3, -1, 2});
      // On the rim the master may end by rounding inside of the slave, but no farther.
      EXPECT_LE(partition_defect(slave, master), 1e-12);
    }
}

TEST(MortarClip, ShiftedMeshesPartition) {
  for (double exponent = -16; exponent <= -1; exponent += 1) {
    const double shift = 0.25 * std::pow(10, exponent);
    const Soup slave = square(4, 0, true, 0.2, 1);
    Soup master = square(4, 0.01, false, 0.2, 1);
    grow(master, 1.5);  // vertices off the grid
    for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0.3, -1, 0), Vec3(-1, 1, 0)}) {
      Soup moved = master;
      move(moved, Mat3::Identity(), shift * way);
      EXPECT_LE(partition_defect(slave, moved), 1e-12) << shift;
    }
    Soup same = square(12, 0.01, false, 0, 1);  // every slave line of a 4 x 4 grid lies on a master line
    Soup outer;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        Soup tile = same;
        move(tile, Mat3::Identity(), Vec3(i + shift, j - 0.7 * shift, 0));
        outer.insert(outer.end(), tile.begin(), tile.end());
      }
    EXPECT_LE(partition_defect(square(4, 0, true, 0, 1), outer), 1e-12) << shift;
  }
}

TEST(MortarClip, SizesOfHundredToOnePartition) {
  Soup large = square(2, 0.01, false, 0.2, 3);
  grow(large, 100.0 / 3);
  move(large, kTurn, {0, 0, 0});
  Soup small = square(3, 0, true, 0.2, 2);
  move(small, kTurn, {0, 0, 0});
  EXPECT_LE(partition_defect(small, large), 1e-12) << "small slave";
  Soup fine = square(120, 0.01, false, 0.3, 4);
  grow(fine, 1.2);
  move(fine, kTurn, {0, 0, 0});
  Soup coarse = square(1, 0, true, 0, 5);
  move(coarse, kTurn, {0, 0, 0});
  EXPECT_LE(partition_defect(coarse, fine), 1e-12) << "large slave";
}

// A master strip of width 1e-13 counts.
TEST(MortarClip, SliversAreKept) {
  const double width = 1e-13;
  const SlavePlane plane = slave_plane({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  double L[3][3];
  const Vec3 master[3] = {{0, 0, 0.1}, {width, 1, 0.1}, {width, 0, 0.1}};
  for (int k = 0; k < 3; ++k) project(plane, master[k], L[k]);
  EXPECT_NEAR(polygon_area(clip(L)) / width, 1, 1e-2);
}

// Both sets of barycentrics of a clipped corner describe one line along the normal.
TEST(MortarClip, CornersLieAboveEachOther) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  int corners = 0;
  for (int n = 0; n < 200; ++n) {
    Vec3 s[3], m[3];
    for (int k = 0; k < 3; ++k) s[k] = {u(random), u(random), 0.1 * u(random)}, m[k] = {u(random), u(random), 1 + 0.3 * u(random)};
    const SlavePlane plane = slave_plane(s[0], s[1], s[2]);
    double L[3][3];
    for (int k = 0; k < 3; ++k) project(plane, m[k], L[k]);
    const Polygon p = clip(L);
    for (int i = 0; i < p.n; ++i, ++corners) {
      Vec3 a = Vec3::Zero(), b = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        a += p.v[i].N[k] * s[k], b += p.v[i].M[k] * m[k];
        EXPECT_GE(p.v[i].N[k], -1e-12);
        EXPECT_GE(p.v[i].M[k], -1e-12);
      }
      EXPECT_LE((b - a).cross(plane.n).norm(), 1e-10 * (1 + 1 / plane.area));
    }
  }
  EXPECT_GT(corners, 200);
}

TEST(MortarQuadrature, RulesIntegratePolynomialsOfTheirDegree) {
  // integral over the triangle of x^a y^b, relative to its area: 2 a! b! / (a + b + 2)!
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  for (const auto& [points, degree] : {std::pair{1, 1}, {3, 2}, {6, 4}, {7, 5}}) {
    double beyond = 0;
    for (int a = 0; a <= degree + 1; ++a)
      for (int b = 0; a + b <= degree + 1; ++b) {
        double sum = 0;
        for (int i = 0; i < points; ++i) {
          const TrianglePoint p = triangle_point(points, i);
          EXPECT_NEAR(p.b[0] + p.b[1] + p.b[2], 1, 1e-15);
          sum += p.weight * std::pow(p.b[1], a) * std::pow(p.b[2], b);
        }
        const double error = std::abs(sum - 2 * factorial(a) * factorial(b) / factorial(a + b + 2));
        if (a + b <= degree)
          EXPECT_LE(error, 1e-15) << points << " points, x^" << a << " y^" << b;
        else
          beyond = std::max(beyond, error);
      }
    EXPECT_GT(beyond, 1e-8) << points << " points are exact beyond their degree: the check is blind";
  }
  for (int points = 1; points <= 3; ++points)
    for (int a = 0; a <= 2 * points - 1; ++a) {
      double sum = 0;
      for (int i = 0; i < points; ++i) sum += segment_point(points, i).weight * std::pow(segment_point(points, i).t, a);
      EXPECT_NEAR(sum, 1.0 / (a + 1), 1e-15);
    }
}
