#include "audit/pressure_error.h"

#include <algorithm>
#include <map>

#include "audit/tuning.h"

namespace mortise::audit {
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

PressureError::Result PressureError::of(const ContactPatch::Fields& f, const std::vector<std::size_t>& group) const {
  struct Group {
    Misses smooth, fit;
    double pressed = 0;
  };
  std::map<std::size_t, Group> groups;
  for (const ContactPatch::Node& node : patch_.interior(f)) {
    Group& of = groups[group.empty() ? 0 : group[patch_.body(node.point)]];
    const double here = f.pressure[node.point];
    of.pressed = std::max(of.pressed, here);
    double expected = 0;
    for (const auto& [j, weight] : node.load) expected += weight * f.pressure[j];
    if (!node.load.empty()) of.fit.add(Eigen::Map<const Vec3>(f.force.data() + 3 * node.point).norm(), std::abs(expected));
    if (node.ring.size() < tuning::kPlane) continue;
    std::vector<Vec3> x;
    std::vector<double> p;
    for (Index j : node.ring) x.push_back(patch_.rest()[j] - patch_.rest()[node.point]), p.push_back(f.pressure[j]);
    of.smooth.add(here, plane_at_origin(x, p));
  }
  double most = 0;
  for (const auto& [number, of] : groups) most = std::max(most, of.pressed);
  Result out;
  out.nodes = patch_.loaded(f.pressure);
  for (const auto& [number, of] : groups) {
    if (of.pressed < tuning::kCounts * most) continue;
    out.roughness = std::fmax(out.roughness, of.smooth.relative());
    out.misfit = std::fmax(out.misfit, of.fit.relative());
  }
  return out;
}

}  // namespace mortise::audit
