// Fields of points over the surface of a body, or at a place of it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "study/measure.h"

namespace mortise::study {
namespace {

using output::CellType;
using output::OutputMesh;
using Corners = std::array<std::int64_t, 3>;

// Corners and middles (01, 12, 20) of the faces of a quadratic tetrahedron, in the order of VTK.
constexpr int kFaces[4][6] = {{0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {2, 0, 3, 6, 7, 9}};

// The triangles of the body's surface; curved faces as four each.
std::vector<Corners> surface(const OutputMesh& mesh, int body) {
  std::vector<Corners> out;
  std::map<Corners, std::pair<int, std::array<std::int64_t, 6>>> faces;  // by sorted corners: how often, and the face
  for (std::size_t c = 0; c < mesh.cells(); ++c) {
    if (mesh.body_of_cell[c] != body) continue;
    const std::int64_t* v = &mesh.connectivity[mesh.offsets[c]];
    if (mesh.types[c] == CellType::triangle) {
      out.push_back({v[0], v[1], v[2]});
      continue;
    }
    const bool curved = mesh.types[c] == CellType::quadratic_tetrahedron;
    for (const auto& f : kFaces) {
      Corners key{v[f[0]], v[f[1]], v[f[2]]};
      std::sort(key.begin(), key.end());
      auto& [count, face] = faces[key];
      ++count;
      for (int k = 0; k < 6; ++k) face[k] = k < 3 || curved ? v[f[k]] : -1;
    }
  }
  for (const auto& [key, entry] : faces) {
    const auto& [count, f] = entry;
    if (count != 1) continue;
    if (f[3] < 0)
      out.push_back({f[0], f[1], f[2]});
    else
      out.insert(out.end(), {Corners{f[0], f[3], f[5]}, Corners{f[3], f[1], f[4]}, Corners{f[5], f[4], f[2]}, Corners{f[3], f[4], f[5]}});
  }
  return out;
}

// Weights of a cell's points at x, in coordinates b of its corners (which add up to 1): linear, or of the quadratic tetrahedron.
std::vector<double> weights(const Eigen::Vector4d& b, bool quadratic) {
  if (!quadratic) return {b[0], b[1], b[2], b[3]};
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  std::vector<double> w;
  for (int i = 0; i < 4; ++i) w.push_back(b[i] * (2 * b[i] - 1));
  for (const auto& e : kEdges) w.push_back(4 * b[e[0]] * b[e[1]]);
  return w;
}

// Coordinates of x in a tetrahedron, or in a triangle, where the fourth is how far x is off its plane in units of the triangle's size.
Eigen::Vector4d coordinates(const OutputMesh& mesh, const std::int64_t* v, bool triangle, const Vec3& x) {
  const Vec3 a = mesh.points[v[0]], u = mesh.points[v[1]] - a, w = mesh.points[v[2]] - a;
  Mat3 m;
  m << u, w, (triangle ? Vec3(u.cross(w) / std::sqrt(u.cross(w).norm())) : Vec3(mesh.points[v[3]] - a));
  const Vec3 b = m.inverse() * (x - a);
  return {triangle ? 1 - b[0] - b[1] : 1 - b.sum(), b[0], b[1], b[2]};
}

}  // namespace

PointWeights weights_at(const OutputMesh& mesh, const Quantity& q) {
  const auto body = static_cast<int>(std::find(mesh.body_names.begin(), mesh.body_names.end(), q.body) - mesh.body_names.begin());
  const Vec3 x = *q.point;
  double best = -INFINITY;
  PointWeights found;
  for (std::size_t c = 0; c < mesh.cells(); ++c) {
    if (mesh.body_of_cell[c] != body) continue;
    const std::int64_t* v = &mesh.connectivity[mesh.offsets[c]];
    const bool triangle = mesh.types[c] == CellType::triangle;
    const Eigen::Vector4d b = coordinates(mesh, v, triangle, x);
    const double inside = triangle ? std::min(b.head<3>().minCoeff(), -std::abs(b[3])) : b.minCoeff();
    if (!(inside > best)) continue;
    best = inside, found.clear();
    const std::vector<double> w = triangle ? std::vector<double>{b[0], b[1], b[2]} : weights(b, mesh.types[c] == CellType::quadratic_tetrahedron);
    for (std::size_t k = 0; k < w.size(); ++k) found.emplace_back(v[k], w[k]);
  }
  // A round body's true surface lies a little outside of its mesh; what is farther off was not meant.
  if (best < -0.5)
    throw Error(Exit::usage, q.place,
                fmt::format("quantity '{}': body '{}' is nowhere near [{:g}, {:g}, {:g}] at rest", q.name, q.body, x[0], x[1], x[2]));
  return found;
}

double over_body(const OutputMesh& mesh, const std::vector<Vec3>& points, const output::FieldValues& field, const Quantity& q,
                 const std::vector<double>& areas) {
  const auto body = static_cast<int>(std::find(mesh.body_names.begin(), mesh.body_names.end(), q.body) - mesh.body_names.begin());
  const std::vector<double>& values = field.values;
  if (q.point) {
    double sum = 0;
    for (const auto& [i, w] : weights_at(mesh, q)) sum += w * values[i];
    return sum;
  }
  if (q.over == "max" || q.over == "min") {
    double least = INFINITY, most = -INFINITY;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (mesh.body_of_point[i] == body) least = std::min(least, values[i]), most = std::max(most, values[i]);
    return q.over == "max" ? most : least;
  }
  std::vector<double> area(points.size(), 0);  // a third of that of the triangles around, as they are now
  for (const Corners& t : surface(mesh, body)) {
    const double a = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm() / 6;
    for (std::int64_t v : t) area[v] += a;
  }
  const double all = std::accumulate(area.begin(), area.end(), 0.0);
  if (!areas.empty()) area = areas;
  double loaded = 0, integral = 0;
  std::vector<std::pair<double, double>> sorted;  // value, area
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (mesh.body_of_point[i] != body || !(area[i] > 0)) continue;
    integral += area[i] * values[i];
    if (values[i] != 0) loaded += area[i], sorted.emplace_back(values[i], area[i]);
  }
  if (q.over == "integral") return integral;
  if (q.over == "area") return loaded;
  if (q.over == "mean") return integral / all;
  std::sort(sorted.begin(), sorted.end());
  double below = 0;
  for (const auto& [value, a] : sorted)
    if ((below += a) >= q.percent / 100 * loaded * (1 - 1e-12)) return value;
  return sorted.empty() ? 0 : sorted.back().first;
}

}  // namespace mortise::study
