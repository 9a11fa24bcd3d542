#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "base/error.h"
#include "effects/mortar_tie/mortar_tie.h"
#include "geometry/bounds.h"
#include "geometry/cut_polygon.h"
#include "geometry/quadratic.h"
#include "geometry/triangle_rule.h"
#include "linalg/dense.h"

namespace mortise::effects::mortar_tie {
namespace {

using Vec2 = Eigen::Vector2d;
using Values = std::vector<double>;  // of the nodes of a face

constexpr double kMiddle = 0.2;      // a
constexpr double kCovered = 1e-6;    // of a face's area: what rounding of clipped polygons may leave
constexpr double kRounding = 1e-12;  // of the slave's face: offsets that rounding makes
constexpr double kFacing = -0.5;     // cosine of the normals of two faces that look at each other

// Shape functions of a face of n nodes at barycentrics l; smooth: N~ in their place.
Values shape(std::size_t n, const double l[3], bool smooth) {
  if (n == 3) return {l[0], l[1], l[2]};
  double q[6];
  geometry::triangle_shape(l, q);
  Values N(q, q + 6);
  if (!smooth) return N;
  for (int e = 0; e < 3; ++e) {
    for (int c : {geometry::edge_begin(e), geometry::edge_end(e)}) N[c] += kMiddle * q[3 + e];
    N[3 + e] *= 1 - 2 * kMiddle;
  }
  return N;
}

// The plane of a face's corners.
struct Plane {
  Vec3 corner[3], normal, e1, e2;
  double area;
  Plane(const model::BodyInput& body, const std::vector<Index>& face) {
    for (int k = 0; k < 3; ++k) corner[k] = body.nodes[face[k]];
    const Vec3 twice = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    area = twice.norm() / 2;
    normal = twice / (2 * area);
    e1 = (corner[1] - corner[0]).normalized();
    e2 = normal.cross(e1);
  }
  Vec2 flat(const Vec3& x) const { return {e1.dot(x - corner[0]), e2.dot(x - corner[0])}; }
};

double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

// Barycentrics of x in the triangle t.
void barycentrics(const Vec2 t[3], const Vec2& x, double l[3]) {
  const double whole = cross(t[1] - t[0], t[2] - t[0]);
  for (int k = 0; k < 3; ++k) l[k] = cross(t[(k + 1) % 3] - x, t[(k + 2) % 3] - x) / whole;
}

// The part of a polygon that lies in the triangle.
std::vector<Vec2> clip(std::vector<Vec2> polygon, const Vec2 t[3]) {
  for (int k = 0; k < 3; ++k) {
    const Vec2 from = t[k], along = t[(k + 1) % 3] - from;
    polygon = geometry::cut(polygon, [&](const Vec2& x) { return cross(along, x - from); });
  }
  return polygon;
}

geometry::Bounds box_of(const model::BodyInput& body, const std::vector<Index>& face) {
  geometry::Bounds out;
  for (int k = 0; k < 3; ++k) out.include(body.nodes[face[k]]);
  return out;
}

// One point of quadrature, on both sides.
struct Point {
  double weight;  // [m^2]
  Values slave, master;
  std::size_t face;  // of the master
};

std::vector<Point> points(const Plane& plane, std::size_t slave_nodes, const Side& master, const std::vector<std::size_t>& near, double reach) {
  std::vector<Point> out;
  const Vec2 t[3] = {plane.flat(plane.corner[0]), plane.flat(plane.corner[1]), plane.flat(plane.corner[2])};
  for (std::size_t f : near) {
    const Plane other(*master.body, master.faces[f]);
    const double facing = other.normal.dot(plane.normal);
    if (facing > kFacing) continue;
    const Vec2 m[3] = {plane.flat(other.corner[0]), plane.flat(other.corner[1]), plane.flat(other.corner[2])};
    const std::vector<Vec2> polygon = clip({m[2], m[1], m[0]}, t);  // seen from the other side
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      const double area = cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]) / 2;
      if (!(area > 0)) continue;
      for (int g = 0; g < 6; ++g) {
        const geometry::TrianglePoint rule = geometry::triangle_point(6, g);
        const Vec2 x = rule.b[0] * polygon[0] + rule.b[1] * polygon[i - 1] + rule.b[2] * polygon[i];
        const Vec3 place = plane.corner[0] + x[0] * plane.e1 + x[1] * plane.e2;
        if (std::abs(other.normal.dot(other.corner[0] - place) / facing) > reach) continue;
        double l[3], b[3];
        barycentrics(t, x, l);
        barycentrics(m, x, b);
        out.push_back({rule.weight * area, shape(slave_nodes, l, true), shape(master.faces[f].size(), b, false), f});
      }
    }
  }
  return out;
}

[[noreturn]] void refuse(const Side& slave, const Side& master, const Plane& plane, double covered, const SourceLoc& at) {
  std::ostringstream why;
  const Vec3 middle = (plane.corner[0] + plane.corner[1] + plane.corner[2]) / 3;
  why << "a face of '" << slave.body->name << "' near [" << middle[0] << ", " << middle[1] << ", " << middle[2] << "] m is ";
  if (covered > plane.area)
    why << "covered twice by '" << master.body->name << "': say which of its faces are meant, by 'to_where' or a smaller 'within'";
  else
    why << "covered by '" << master.body->name << "' to " << 100 * covered / plane.area
        << " % only: the side that reaches farther has to be the one that is tied 'to'; or the two are farther apart than 'within'";
  throw Error(Exit::scene, at, why.str());
}

// grad lambda of the corners of the tetrahedron behind a face.
struct Behind {
  Tet tet;
  Vec3 gradient[4];
};
Behind behind(const Side& side, std::size_t face) {
  const std::vector<Index>& f = side.faces[face];
  const auto& tets = side.body->tets;
  const auto found = std::find_if(tets.begin(), tets.end(), [&](const Tet& t) {
    return std::all_of(f.begin(), f.begin() + 3, [&](Index n) { return std::find(t.v, t.v + 4, n) != t.v + 4; });
  });
  Behind out;
  out.tet = *found;
  Mat3 dm;
  for (int k = 0; k < 3; ++k) dm.col(k) = side.body->nodes[out.tet.v[k + 1]] - side.body->nodes[out.tet.v[0]];
  const Mat3 inverse = dm.inverse();
  out.gradient[0] = Vec3::Zero();
  for (int k = 0; k < 3; ++k) out.gradient[k + 1] = inverse.row(k), out.gradient[0] -= inverse.row(k).transpose();
  return out;
}

}  // namespace

Side side_of(const model::BodyInput& body, const std::vector<Index>& nodes) {
  Side out{&body, {}};
  const auto mark = [&](const Index* v, int n) {
    if (std::all_of(v, v + n, [&](Index i) { return std::binary_search(nodes.begin(), nodes.end(), i); })) out.faces.emplace_back(v, v + n);
  };
  if (body.faces.empty())
    for (const Triangle& t : body.triangles) mark(t.v, 3);
  else
    for (const geometry::Face& f : body.faces) mark(f.v, 6);
  return out;
}

std::vector<Row> rows(const Side& slave, const Side& master, double reach, const SourceLoc& at) {
  std::vector<geometry::Bounds> boxes;
  for (const auto& f : master.faces) boxes.push_back(box_of(*master.body, f).grown(reach));
  struct Slave {
    double c = 0;
    std::map<Index, double> terms;       // c w
    std::map<std::size_t, double> seen;  // master faces: how much of them
  };
  std::map<Index, Slave> nodes;
  std::map<Index, std::array<Index, 2>> middle;  // node in the middle of an edge: its ends
  for (const auto& face : slave.faces) {
    const Plane plane(*slave.body, face);
    const geometry::Bounds box = box_of(*slave.body, face);
    std::vector<std::size_t> near;
    for (std::size_t f = 0; f < boxes.size(); ++f)
      if (box.meets(boxes[f])) near.push_back(f);
    const std::vector<Point> all = points(plane, face.size(), master, near, reach);
    const auto n = static_cast<Index>(face.size());
    double covered = 0;
    Values c(n, 0.0);
    linalg::DenseMatrix M(n, n), C(n, n);
    for (const Point& p : all) {
      covered += p.weight;
      for (Index a = 0; a < n; ++a) {
        c[a] += p.weight * p.slave[a];
        for (Index b = 0; b < n; ++b) M(a, b) += p.weight * p.slave[a] * p.slave[b];
      }
    }
    if (std::abs(covered - plane.area) > kCovered * plane.area) refuse(slave, master, plane, covered, at);
    for (Index a = 0; a < n; ++a) C(a, a) = c[a];
    const linalg::DenseMatrix dual = linalg::solve(M, C);  // M^-1 C: psi_a = sum_b dual_ba N_b
    for (const Point& p : all)
      for (Index a = 0; a < n; ++a) {
        double psi = 0;
        for (Index b = 0; b < n; ++b) psi += dual(b, a) * p.slave[b];
        Slave& node = nodes[face[a]];
        node.seen[p.face] += p.weight;
        for (std::size_t k = 0; k < master.faces[p.face].size(); ++k) node.terms[master.faces[p.face][k]] += p.weight * psi * p.master[k];
      }
    for (Index a = 0; a < n; ++a) nodes[face[a]].c += c[a];
    for (std::size_t e = 0; e + 3 < face.size(); ++e)
      middle[face[3 + e]] = {face[geometry::edge_begin(static_cast<int>(e))], face[geometry::edge_end(static_cast<int>(e))]};
  }

  std::vector<Row> out;
  for (const auto& [j, node] : nodes) {
    std::map<Index, double> w;
    const auto add = [&](const Slave& of, double fraction) {
      for (const auto& [k, cw] : of.terms) w[k] += fraction * cw / of.c;
    };
    if (const auto m = middle.find(j); m != middle.end()) {
      add(node, 1 - 2 * kMiddle);
      for (Index end : m->second) add(nodes.at(end), kMiddle);
    } else {
      add(node, 1);
    }
    Vec3 d = slave.body->nodes[j];
    for (const auto& [k, weight] : w) d -= weight * master.body->nodes[k];
    if (d.squaredNorm() > kRounding * kRounding * node.c) {
      const auto largest = std::max_element(node.seen.begin(), node.seen.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
      const Behind tet = behind(master, largest->first);
      for (int k = 0; k < 4; ++k) w[tet.tet.v[k]] += tet.gradient[k].dot(d);
    }
    Row row{j, {}};
    for (const auto& [k, weight] : w) row.terms.push_back({k, weight});
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace mortise::effects::mortar_tie
