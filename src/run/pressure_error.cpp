#include "run/pressure_error.h"

#include <algorithm>

#include "run/tuning.h"

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
  decomposition.setThreshold(tuning::kFlat);
  return decomposition.solve(b)[0];
}

// Root mean square of differences over that of the larger of the two: at most 1 where one of them vanishes everywhere.
struct Misses {
  double missed = 0, all = 0;
  void add(double is, double expected) { missed += (is - expected) * (is - expected), all += std::max(is * is, expected * expected); }
  double relative() const { return all > 0 ? std::sqrt(missed / all) : NAN; }
};

}  // namespace

PressureError::Result PressureError::of(const ContactPatch::Fields& f) const {
  Misses smooth, fit;
  for (const ContactPatch::Node& node : patch_.interior(f)) {
    const double here = f.pressure[node.point];
    double expected = 0;
    for (const auto& [j, weight] : node.load) expected += weight * f.pressure[j];
    if (!node.load.empty()) fit.add(Eigen::Map<const Vec3>(f.force.data() + 3 * node.point).norm(), std::abs(expected));
    if (node.ring.size() < tuning::kPlane) continue;
    std::vector<Vec3> x;
    std::vector<double> p;
    for (Index j : node.ring) x.push_back(patch_.rest()[j] - patch_.rest()[node.point]), p.push_back(f.pressure[j]);
    smooth.add(here, plane_at_origin(x, p));
  }
  return {smooth.relative(), fit.relative(), patch_.loaded(f.pressure)};
}

}  // namespace mortise::run
