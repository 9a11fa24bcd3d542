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

// Root mean square of differences over that of the larger of the two: at most 1 where one of them vanishes everywhere.
struct Misses {
  double missed = 0, all = 0;
  void add(double is, double expected) { missed += (is - expected) * (is - expected), all += std::max(is * is, expected * expected); }
  double share() const { return all > 0 ? std::sqrt(missed / all) : NAN; }
};

}  // namespace

double PressureError::roughness(const std::vector<ContactPatch::Node>& interior, std::span<const double> pressure) const {
  constexpr std::size_t kPlane = 4;  // a plane through three neighbours has no say about a fourth
  Misses sums;
  for (const ContactPatch::Node& node : interior) {
    if (node.ring.size() < kPlane) continue;
    std::vector<Vec3> x;
    std::vector<double> p;
    for (Index j : node.ring) x.push_back(patch_.rest()[j] - patch_.rest()[node.point]), p.push_back(pressure[j]);
    sums.add(pressure[node.point], plane_at_origin(x, p));
  }
  return sums.share();
}

double PressureError::misfit(const std::vector<ContactPatch::Node>& interior, std::span<const double> pressure, std::span<const double> force,
                             std::span<const double> displacement) const {
  if (force.size() != 3 * patch_.rest().size()) return NAN;
  std::vector<double> area(patch_.rest().size(), 0.0);  // of nodes, as they stand now [m^2]
  const auto at = [&](Index i) -> Vec3 {
    return displacement.size() != force.size() ? patch_.rest()[i] : patch_.rest()[i] + Eigen::Map<const Vec3>(displacement.data() + 3 * i);
  };
  for (const Triangle& t : patch_.triangles()) {
    const double third = (at(t.v[1]) - at(t.v[0])).cross(at(t.v[2]) - at(t.v[0])).norm() / 6;
    for (Index v : t.v) area[v] += third;
  }
  Misses sums;
  for (const ContactPatch::Node& node : interior)
    if (area[node.point] > 0) sums.add(Eigen::Map<const Vec3>(force.data() + 3 * node.point).norm(), pressure[node.point] * area[node.point]);
  return sums.share();
}

PressureError::Result PressureError::of(std::span<const double> pressure, std::span<const double> force, std::span<const double> displacement) const {
  if (pressure.empty()) return {};
  const std::vector<ContactPatch::Node> interior = patch_.interior(pressure);
  return {roughness(interior, pressure), misfit(interior, pressure, force, displacement), patch_.loaded(pressure)};
}

}  // namespace mortise::run
