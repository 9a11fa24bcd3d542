#include "geometry/topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace mortise::geometry {
namespace {

// Outward faces of a positively oriented tetrahedron; face i lies opposite vertex i.
constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

template <class Element, int N>
std::vector<Index> renumbering(std::size_t points, const std::vector<Element>& elements, Index& used) {
  std::vector<Index> number(points, -1);
  for (const Element& e : elements)
    for (int k = 0; k < N; ++k) number[e.v[k]] = 0;
  used = 0;
  for (Index& n : number)
    if (n == 0) n = used++;
  return number;
}

template <class Mesh, class Element, int N>
Mesh compact(const std::vector<Vec3>& points, std::vector<Element> elements, std::vector<Element> Mesh::*member, std::vector<Index>* source) {
  Index used = 0;
  const std::vector<Index> number = renumbering<Element, N>(points.size(), elements, used);
  Mesh out;
  out.points.reserve(used);
  if (source) source->clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (number[i] < 0) continue;
    out.points.push_back(points[i]);
    if (source) source->push_back(static_cast<Index>(i));
  }
  for (Element& e : elements)
    for (int k = 0; k < N; ++k) e.v[k] = number[e.v[k]];
  out.*member = std::move(elements);
  return out;
}

double triangle_area(const std::vector<Vec3>& points, const Triangle& t) {
  const Vec3 &a = points[t.v[0]], &b = points[t.v[1]], &c = points[t.v[2]];
  return 0.5 * (b - a).cross(c - a).norm();
}

}  // namespace

std::vector<Triangle> boundary_triangles(const TetMesh& mesh) {
  struct Face {
    std::array<Index, 3> key;
    Index id;  // 4 * tet + face
  };
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int f = 0; f < 4; ++f) {
      const Tet& tet = mesh.tets[t];
      Face face{{tet.v[kFaces[f][0]], tet.v[kFaces[f][1]], tet.v[kFaces[f][2]]}, static_cast<Index>(4 * t + f)};
      std::sort(face.key.begin(), face.key.end());
      faces.push_back(face);
    }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.key != b.key ? a.key < b.key : a.id < b.id; });

  std::vector<Index> single;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t j = i + 1;
    while (j < faces.size() && faces[j].key == faces[i].key) ++j;
    if (j - i == 1) single.push_back(faces[i].id);
    i = j;
  }
  std::sort(single.begin(), single.end());

  std::vector<Triangle> out;
  out.reserve(single.size());
  for (Index id : single) {
    const Tet& tet = mesh.tets[id / 4];
    const int* f = kFaces[id % 4];
    out.push_back({{tet.v[f[0]], tet.v[f[1]], tet.v[f[2]]}});
  }
  return out;
}

TriMesh surface_of(const TetMesh& mesh, std::vector<Index>* source) {
  return compact<TriMesh, Triangle, 3>(mesh.points, boundary_triangles(mesh), &TriMesh::triangles, source);
}

void append(const TriMesh& more, TriMesh& to) {
  const auto first = static_cast<Index>(to.points.size());
  to.points.insert(to.points.end(), more.points.begin(), more.points.end());
  for (const Triangle& t : more.triangles) to.triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
}

TriMesh without_unused_points(const TriMesh& mesh) {
  return compact<TriMesh, Triangle, 3>(mesh.points, mesh.triangles, &TriMesh::triangles, nullptr);
}

TetMesh without_unused_points(const TetMesh& mesh) {
  if (!mesh.quadratic()) return compact<TetMesh, Tet, 4>(mesh.points, mesh.tets, &TetMesh::tets, nullptr);
  std::vector<Index> number(mesh.points.size(), -1);
  for (const Tet& t : mesh.tets)
    for (Index v : t.v) number[v] = 0;
  for (const Midsides& m : mesh.midsides)
    for (Index v : m.v) number[v] = 0;
  TetMesh out{{}, mesh.tets, mesh.midsides};
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<Index>(out.points.size());
    out.points.push_back(mesh.points[i]);
  }
  for (Tet& t : out.tets)
    for (Index& v : t.v) v = number[v];
  for (Midsides& m : out.midsides)
    for (Index& v : m.v) v = number[v];
  return out;
}

std::vector<Edge> unique_edges(const std::vector<Triangle>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const Index a = t.v[k], b = t.v[(k + 1) % 3];
      edges.push_back({{std::min(a, b), std::max(a, b)}});
    }
  const auto key = [](const Edge& e) { return std::pair(e.v[0], e.v[1]); };
  std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
  edges.erase(std::unique(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) == key(b); }), edges.end());
  return edges;
}

std::vector<double> vertex_areas(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  std::vector<double> w(points.size(), 0.0);
  for (const Triangle& t : triangles) {
    const double third = triangle_area(points, t) / 3;
    for (Index v : t.v) w[v] += third;
  }
  return w;
}

std::vector<double> edge_areas(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, const std::vector<Edge>& edges) {
  std::vector<double> w(edges.size(), 0.0);
  for (const Triangle& t : triangles) {
    const double third = triangle_area(points, t) / 3;
    for (int k = 0; k < 3; ++k) {
      const std::pair key = std::minmax(t.v[k], t.v[(k + 1) % 3]);
      const auto at = std::lower_bound(edges.begin(), edges.end(), key,
                                       [](const Edge& e, const std::pair<Index, Index>& k) { return std::pair(e.v[0], e.v[1]) < k; });
      w[at - edges.begin()] += third;
    }
  }
  return w;
}

double area(const TriMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += triangle_area(mesh.points, t);
  return sum;
}

double tet_volume(const std::vector<Vec3>& points, const Tet& tet) {
  const Vec3 &a = points[tet.v[0]], &b = points[tet.v[1]], &c = points[tet.v[2]], &d = points[tet.v[3]];
  return (b - a).cross(c - a).dot(d - a) / 6;
}

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet& t : mesh.tets) sum += tet_volume(mesh.points, t);
  return sum;
}

double min_dihedral_angle(const TetMesh& mesh) {
  double smallest = M_PI;
  for (const Tet& t : mesh.tets) {
    std::array<Vec3, 4> normal;
    for (int f = 0; f < 4; ++f) {
      const Vec3 &a = mesh.points[t.v[kFaces[f][0]]], &b = mesh.points[t.v[kFaces[f][1]]], &c = mesh.points[t.v[kFaces[f][2]]];
      normal[f] = (b - a).cross(c - a);
    }
    // Outward normals of two faces enclose pi minus the dihedral angle between them.
    for (int f = 0; f < 4; ++f)
      for (int g = f + 1; g < 4; ++g) smallest = std::min(smallest, M_PI - std::atan2(normal[f].cross(normal[g]).norm(), normal[f].dot(normal[g])));
  }
  return smallest;
}

Mat3 MassProperties::inertia(double density) const { return density * (second_moment.trace() * Mat3::Identity() - second_moment); }
Mat3 second_moment_of(const Mat3& inertia) { return 0.5 * inertia.trace() * Mat3::Identity() - inertia; }

// The inside is the signed sum of the tetrahedra (o, a, b, c) over all triangles. With D = det(a,b,c) measured from o:
//   int dV = D/6,   int x dV = D/24 (a+b+c),   int x x^T dV = D/120 (a a^T + b b^T + c c^T + s s^T),  s = a+b+c.
// o = mean of the points keeps cancellation small for bodies far from the origin.
MassProperties mass_properties(const TriMesh& mesh) {
  MassProperties m;
  if (mesh.points.empty()) return m;
  Vec3 o = Vec3::Zero();
  for (const Vec3& p : mesh.points) o += p;
  o /= static_cast<double>(mesh.points.size());

  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.points[t.v[0]] - o, b = mesh.points[t.v[1]] - o, c = mesh.points[t.v[2]] - o;
    const double det = a.dot(b.cross(c));
    const Vec3 s = a + b + c;
    m.volume += det / 6;
    first += det / 24 * s;
    second += det / 120 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  if (m.volume == 0) return m;
  const Vec3 shift = first / m.volume;
  m.centroid = o + shift;
  m.second_moment = second - m.volume * shift * shift.transpose();
  return m;
}

std::vector<Index> connected_components(const TriMesh& mesh) {
  std::vector<Index> root(mesh.points.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::vector<char> used(mesh.points.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      used[t.v[k]] = 1;
      const Index a = find(t.v[0]), b = find(t.v[k]);
      root[std::max(a, b)] = std::min(a, b);
    }
  std::vector<Index> component(mesh.points.size(), -1);
  Index count = 0;
  for (std::size_t i = 0; i < root.size(); ++i) {
    if (!used[i]) continue;
    const Index r = find(static_cast<Index>(i));  // the root is the lowest point of its component
    component[i] = r == static_cast<Index>(i) ? count++ : component[r];
  }
  return component;
}

Index component_count(const std::vector<Index>& component) {
  return component.empty() ? 0 : 1 + *std::max_element(component.begin(), component.end());
}

}  // namespace mortise::geometry
