#include "run/pressure_error.h"

#include <algorithm>

namespace mortise::run {
namespace {

// Value at the origin of the plane p = c0 + g . x nearest to the pressures at x; of all such planes the flattest.
double plane_at_origin(const std::vector<Vec3>& x, const std::vector<double>& p) {
  Eigen::MatrixXd A(x.size(), 4);
  Eigen::VectorXd b(x.size());
  double length = 0;
  for (const Vec3& v : x) length = std::max(length, v.norm());
  for (std::size_t i = 0; i < x.size(); ++i) {
    A.row(i) << 1, x[i][0] / length, x[i][1] / length, x[i][2] / length;
    b[i] = p[i];
  }
  auto decomposition = A.completeOrthogonalDecomposition();
  decomposition.setThreshold(0.05);  // the ring of a node lies nearly in a plane: no slope across it
  return decomposition.solve(b)[0];
}

}  // namespace

PressureError::PressureError(const model::ModelInput& input) {
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    const Index first = static_cast<Index>(ring_.size());
    ring_.resize(ring_.size() + in.nodes.size());
    rest_.insert(rest_.end(), in.nodes.begin(), in.nodes.end());
    if (in.type != model::BodyType::soft) continue;
    for (const Triangle& t : in.triangles)
      for (int k = 0; k < 3; ++k)
        for (int other : {(k + 1) % 3, (k + 2) % 3}) ring_[first + t.v[k]].push_back(first + t.v[other]);
  }
  for (std::vector<Index>& ring : ring_) {
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  }
}

PressureError::Result PressureError::of(std::span<const double> pressure) const {
  constexpr std::size_t kPlane = 4;  // a plane through three neighbours has no say about a fourth
  Result r;
  double missed = 0, all = 0;
  for (std::size_t i = 0; i < ring_.size(); ++i) {
    if (ring_[i].empty() || !(pressure[i] > 0)) continue;
    ++r.nodes;
    if (ring_[i].size() < kPlane || std::any_of(ring_[i].begin(), ring_[i].end(), [&](Index j) { return !(pressure[j] > 0); })) continue;
    std::vector<Vec3> x;
    std::vector<double> p;
    for (Index j : ring_[i]) x.push_back(rest_[j] - rest_[i]), p.push_back(pressure[j]);
    const double miss = pressure[i] - plane_at_origin(x, p);
    missed += miss * miss, all += pressure[i] * pressure[i];
  }
  if (all > 0) r.roughness = std::sqrt(missed / all);
  return r;
}

}  // namespace mortise::run
