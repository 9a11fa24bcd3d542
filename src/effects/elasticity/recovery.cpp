#include "effects/elasticity/recovery.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "geometry/quadratic.h"

namespace mortise::effects::elasticity {
namespace {

using Polynomial = Eigen::Matrix<double, 10, 1>;
constexpr std::size_t kFewest = 6;  // elements: their 24 points fit ten coefficients with some to spare
constexpr double kRidge = 1e-12;    // of the largest: what points do not tell of a polynomial is zero

Polynomial terms(const Vec3& x) {
  return (Polynomial() << 1, x[0], x[1], x[2], x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[1] * x[2], x[2] * x[0]).finished();
}

struct Mesh {
  std::vector<Tet> tet;
  std::vector<geometry::Midsides> midsides;
  std::vector<Index> first_point;
  std::vector<double> volume;
  std::vector<Vec3> rest;
  std::vector<std::vector<Index>> around;  // of every block

  explicit Mesh(const model::Model& m)
      : tet(m.volume.tets.download()),
        midsides(m.volume.midsides.download()),
        first_point(m.volume.first_point.download()),
        volume(m.volume.rest_volume.download()),
        rest(m.rest.download()),
        around(m.blocks) {
    for (Index t = 0; t < static_cast<Index>(tet.size()); ++t)
      for (int a = 0; a < nodes(t); ++a) around[node(t, a)].push_back(t);
  }
  bool quadratic(Index t) const { return first_point[t + 1] - first_point[t] > 1; }
  int nodes(Index t) const { return quadratic(t) ? 10 : 4; }
  Index node(Index t, int a) const { return a < 4 ? tet[t].v[a] : midsides[t].v[a - 4]; }
  Vec3 place(Index t, int point) const {
    double l[4];
    geometry::tet_point(point, l);
    Vec3 x = Vec3::Zero();
    for (int a = 0; a < 10; ++a) x += geometry::tet_shape_function(a, l) * rest[node(t, a)];
    return x;
  }
};

using Weights = std::vector<std::pair<Index, double>>;  // of points

Weights average(const Mesh& m, Index block) {
  Weights out;
  double all = 0;
  for (Index t : m.around[block]) all += m.volume[m.first_point[t]];
  for (Index t : m.around[block]) out.emplace_back(m.first_point[t], m.volume[m.first_point[t]] / all);
  return out;
}

// At x, share times the polynomial that is fitted around a corner.
void fit(const Mesh& m, Index corner, const Vec3& x, double share, Weights& out) {
  std::vector<Index> patch = m.around[corner];
  if (patch.size() < kFewest) {
    for (Index t : std::vector<Index>(patch))
      for (Index v : m.tet[t].v) patch.insert(patch.end(), m.around[v].begin(), m.around[v].end());
    std::sort(patch.begin(), patch.end());
    patch.erase(std::unique(patch.begin(), patch.end()), patch.end());
  }
  double size = 0;
  for (Index t : patch)
    for (int p = 0; p < geometry::kTetPoints; ++p) size = std::max(size, (m.place(t, p) - m.rest[corner]).norm());
  const auto at = [&](const Vec3& y) { return terms((y - m.rest[corner]) / size); };
  Eigen::Matrix<double, 10, 10> normal = Eigen::Matrix<double, 10, 10>::Zero();
  for (Index t : patch)
    for (int p = 0; p < geometry::kTetPoints; ++p) normal += at(m.place(t, p)) * at(m.place(t, p)).transpose();
  normal.diagonal().array() += kRidge * normal.diagonal().maxCoeff();
  const Polynomial of_x = normal.ldlt().solve(at(x));
  for (Index t : patch)
    for (int p = 0; p < geometry::kTetPoints; ++p) out.emplace_back(m.first_point[t] + p, share * of_x.dot(at(m.place(t, p))));
}

}  // namespace

Recovery::Recovery(const model::Model& model) {
  const Mesh m(model);
  // Corners of the edge in whose middle a block stands; of corners themselves, twice.
  std::vector<std::array<Index, 2>> ends(model.blocks, {-1, -1});
  for (Index t = 0; t < static_cast<Index>(m.tet.size()); ++t)
    for (int a = 0; m.quadratic(t) && a < 10; ++a)
      ends[m.node(t, a)] = a < 4 ? std::array<Index, 2>{m.node(t, a), m.node(t, a)}
                                 : std::array<Index, 2>{m.node(t, geometry::edge_begin(a - 4)), m.node(t, geometry::edge_end(a - 4))};
  for (Index b = 0; b < model.blocks; ++b) {
    Weights of;
    if (ends[b][0] < 0) {
      of = average(m, b);
    } else {
      fit(m, ends[b][0], m.rest[b], ends[b][0] == ends[b][1] ? 1 : 0.5, of);
      if (ends[b][0] != ends[b][1]) fit(m, ends[b][1], m.rest[b], 0.5, of);
    }
    for (const auto& [p, w] : of) point.push_back(p), weight.push_back(w);
    first.push_back(static_cast<Index>(point.size()));
  }
}

Recovery Recovery::transposed(Index points) const {
  Recovery out;
  out.first.assign(points + 1, 0);
  for (Index p : point) ++out.first[p + 1];
  for (Index p = 0; p < points; ++p) out.first[p + 1] += out.first[p];
  out.point.resize(point.size()), out.weight.resize(point.size());
  std::vector<Index> next = out.first;
  for (Index b = 0; b + 1 < static_cast<Index>(first.size()); ++b)
    for (Index i = first[b]; i < first[b + 1]; ++i) out.point[next[point[i]]] = b, out.weight[next[point[i]]++] = weight[i];
  return out;
}

}  // namespace mortise::effects::elasticity
