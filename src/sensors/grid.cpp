#include "sensors/grid.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/cut_edges.h"

namespace mortise::sensors {
namespace {

constexpr double kFacing = 0.05;  // least n . z of the surface that counts
constexpr double kEdge = 0.4;     // of a taxel: of a peg on four of them 2 % of the force were beside them, with whole taxels 25 %

// A corner of a piece: place in the plane of the grid, and barycentrics on the triangle.
struct Corner {
  double x[2], N[3];
};
using Polygon = std::vector<Corner>;

Corner between(const Corner& a, const Corner& b, double t) {
  Corner c;
  for (int k = 0; k < 2; ++k) c.x[k] = a.x[k] + t * (b.x[k] - a.x[k]);
  for (int k = 0; k < 3; ++k) c.N[k] = a.N[k] + t * (b.N[k] - a.N[k]);
  return c;
}

// The part of the polygon with sign (x[axis] - line) >= 0 (Sutherland, Hodgman 1974).
Polygon clip(const Polygon& p, int axis, double line, double sign) {
  Polygon out;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Corner &a = p[i], &b = p[(i + 1) % p.size()];
    const double da = sign * (a.x[axis] - line), db = sign * (b.x[axis] - line);
    if (da >= 0) out.push_back(a);
    if ((da >= 0) != (db >= 0)) {
      // From the same end in both cells at the line, so that both get the same corner.
      Corner c = a.x[axis] < b.x[axis] ? between(a, b, (line - a.x[axis]) / (b.x[axis] - a.x[axis]))
                                       : between(b, a, (line - b.x[axis]) / (a.x[axis] - b.x[axis]));
      c.x[axis] = line;
      out.push_back(c);
    }
  }
  return out;
}

// Area in the plane, and the barycentrics of the centroid times that area.
double integrate(const Polygon& p, double N[3]) {
  double sum = 0;
  N[0] = N[1] = N[2] = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Corner &o = p[0], &a = p[i], &b = p[i + 1];
    const double area = ((a.x[0] - o.x[0]) * (b.x[1] - o.x[1]) - (b.x[0] - o.x[0]) * (a.x[1] - o.x[1])) / 2;
    sum += area;
    for (int k = 0; k < 3; ++k) N[k] += area * (o.N[k] + a.N[k] + b.N[k]) / 3;
  }
  return sum;
}

// Corner triangles of the surface, and how the force on a node is handed to corners: (corner, part) per node.
struct Carriers {
  std::vector<Triangle> triangles;
  std::vector<std::vector<std::pair<Index, double>>> of;
};

Carriers carriers(const model::BodyInput& body) {
  Carriers c;
  c.triangles = body.triangles;
  c.of.resize(body.nodes.size());
  for (std::size_t i = 0; i < c.of.size(); ++i) c.of[i] = {{static_cast<Index>(i), 1.0}};
  if (body.faces.empty()) return c;
  c.triangles.clear();
  for (const geometry::Face& f : body.faces) {
    c.triangles.push_back({{f.v[0], f.v[1], f.v[2]}});
    for (int e = 0; e < 3; ++e) c.of[f.v[3 + e]] = {{f.v[e], 0.5}, {f.v[(e + 1) % 3], 0.5}};
  }
  return c;
}

double triangle_area(const std::vector<Vec3>& x, const Triangle& t) { return (x[t.v[1]] - x[t.v[0]]).cross(x[t.v[2]] - x[t.v[0]]).norm() / 2; }

// Does a triangle with these corners face the grid, near enough? local: they in the grid's frame.
bool belongs(const Vec3 (&corner)[3], const GridSpec& spec, Vec3 (&local)[3]) {
  double far = 0;
  for (int k = 0; k < 3; ++k) {
    local[k] = spec.frame.axes.transpose() * (corner[k] - spec.frame.origin);
    far = std::max(far, std::abs(local[k][2]));
  }
  const Vec3 twice = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  return twice.dot(spec.frame.axes.col(2)) > kFacing * twice.norm() && far <= spec.depth;
}

// Does it reach into the grid besides?
bool lies_in(const Vec3 (&corner)[3], const GridSpec& spec) {
  Vec3 local[3];
  if (!belongs(corner, spec, local)) return false;
  const auto reaches = [&](int axis, double size) {
    const auto [low, high] = std::minmax({local[0][axis], local[1][axis], local[2][axis]});
    return low < size / 2 && high > -size / 2;
  };
  return reaches(0, spec.width) && reaches(1, spec.height);
}

}  // namespace

GridSpec grid_of(const Params& p) {
  GridSpec s;
  s.rows = static_cast<int>(p.integer("rows")), s.columns = static_cast<int>(p.integer("columns"));
  s.width = p.number("width"), s.height = p.number("height");
  if (const Params* depth = p.find("depth")) s.depth = depth->as_number();
  s.frame.origin = p.vec3("position");
  const Vec3 z = p.vec3("normal").normalized(), up = p.vec3("up");
  s.frame.axes.col(1) = (up - up.dot(z) * z).normalized();
  s.frame.axes.col(2) = z;
  s.frame.axes.col(0) = s.frame.axes.col(1).cross(z);
  return s;
}

TaxelGrid::TaxelGrid(const model::BodyInput& body, const GridSpec& spec) : taxels_(spec.taxels()) {
  const Carriers carry = carriers(body);
  std::vector<double> hat(body.nodes.size(), 0.0);  // int N_a dA over the surface that faces the grid
  std::vector<Weight> integral;                     // int_i N_a dA
  for (const Triangle& t : carry.triangles) {
    const Vec3 at[3] = {body.nodes[t.v[0]], body.nodes[t.v[1]], body.nodes[t.v[2]]};
    Vec3 corner[3];
    if (!belongs(at, spec, corner)) continue;
    const double area = triangle_area(body.nodes, t);
    for (Index v : t.v) hat[v] += area / 3;
    triangles_.push_back(t);
    cut(spec, static_cast<Index>(triangles_.size()) - 1, corner, area, integral);
  }
  rest_area_.assign(taxels_, 0.0);
  for (const Piece& p : pieces_) rest_area_[p.taxel] += p.part * triangle_area(body.nodes, triangles_[p.triangle]);

  std::map<std::pair<Index, Index>, double> distribute, mean;
  std::vector<std::vector<std::pair<Index, double>>> from(body.nodes.size());  // corner -> nodes whose force it carries
  for (std::size_t i = 0; i < carry.of.size(); ++i)
    for (const auto& [corner, part] : carry.of[i]) from[corner].push_back({static_cast<Index>(i), part});
  for (const Weight& w : integral) {
    for (const auto& [node, part] : from[w.node]) distribute[{w.taxel, node}] += part * w.value / hat[w.node];
    mean[{w.taxel, w.node}] += w.value / rest_area_[w.taxel];
  }
  for (const auto& [at, value] : distribute) fraction_.push_back({at.first, at.second, value});
  for (const auto& [at, value] : mean) mean_.push_back({at.first, at.second, value});
}

void TaxelGrid::cut(const GridSpec& spec, Index triangle, const Vec3 corner[3], double area, std::vector<Weight>& integral) {
  Polygon whole;
  for (int k = 0; k < 3; ++k) whole.push_back({{corner[k][0], corner[k][1]}, {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0}});
  double N[3];
  const double flat = integrate(whole, N);  // > 0: it faces the grid
  const auto line = [](double size, int n, int i) { return size * i / n - size / 2; };
  const auto range = [&](int axis, double size, int n, int& first, int& last) {
    const double lo = std::min({corner[0][axis], corner[1][axis], corner[2][axis]}),
                 hi = std::max({corner[0][axis], corner[1][axis], corner[2][axis]});
    first = std::max(0, static_cast<int>(std::floor(std::max(-1.0, (lo + size / 2) / size * n))) - 1);
    last = std::min(n - 1, static_cast<int>(std::floor(std::min(n + 1.0, (hi + size / 2) / size * n))) + 1);
  };
  int c0, c1, r0, r1;
  range(0, spec.width, spec.columns, c0, c1), range(1, spec.height, spec.rows, r0, r1);
  for (int r = r0; r <= r1; ++r) {
    const Polygon strip = clip(clip(whole, 1, line(spec.height, spec.rows, r), 1), 1, line(spec.height, spec.rows, r + 1), -1);
    for (int c = c0; c <= c1 && !strip.empty(); ++c) {
      const Polygon cell = clip(clip(strip, 0, line(spec.width, spec.columns, c), 1), 0, line(spec.width, spec.columns, c + 1), -1);
      const double part = integrate(cell, N) / flat;
      if (!(part > 0)) continue;
      const Index taxel = r * spec.columns + c;
      pieces_.push_back({taxel, triangle, part});
      for (int k = 0; k < 3; ++k) integral.push_back({taxel, triangles_[triangle].v[k], N[k] / flat * area});
    }
  }
}

std::vector<Vec3> TaxelGrid::distribute(const std::vector<Vec3>& force) const {
  std::vector<Vec3> out(taxels_, Vec3::Zero());
  for (const Weight& w : fraction_) out[w.taxel] += w.value * force[w.node];
  return out;
}

std::vector<Vec3> TaxelGrid::mean(const std::vector<Vec3>& value) const {
  std::vector<Vec3> out(taxels_, Vec3::Zero());
  for (const Weight& w : mean_) out[w.taxel] += w.value * value[w.node];
  return out;
}

std::vector<double> TaxelGrid::area(const std::vector<Vec3>& node) const {
  std::vector<double> out(taxels_, 0.0);
  for (const Piece& p : pieces_) out[p.taxel] += p.part * triangle_area(node, triangles_[p.triangle]);
  return out;
}

std::size_t TaxelGrid::bytes() const {
  return triangles_.size() * sizeof(Triangle) + pieces_.size() * sizeof(Piece) + (fraction_.size() + mean_.size()) * sizeof(Weight) +
         rest_area_.size() * sizeof(double);
}

void refine(model::BodyInput& stiff, const GridSpec& spec) {
  geometry::TriMesh mesh{std::move(stiff.nodes), std::move(stiff.triangles)};
  geometry::cut_edges(mesh, kEdge * std::sqrt(spec.width * spec.height / spec.taxels()),
                      [&](const Vec3(&corner)[3]) { return lies_in(corner, spec); });
  stiff.nodes = std::move(mesh.points), stiff.triangles = std::move(mesh.triangles);
}

bool turned_around(const model::BodyInput& body, GridSpec spec) {
  constexpr double kOnIt = 0.02;  // of the grid's size: a surface so near is the one that is meant
  spec.depth = kOnIt * std::max(spec.width, spec.height);
  if (TaxelGrid(body, spec).whole_area() > 0) return false;
  spec.frame.axes.col(0) *= -1, spec.frame.axes.col(2) *= -1;
  return TaxelGrid(body, spec).whole_area() > 0.5 * spec.width * spec.height;
}

}  // namespace mortise::sensors
