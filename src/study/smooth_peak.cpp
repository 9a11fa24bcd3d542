#include "study/smooth_peak.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "study/tuning.h"

namespace mortise::study {
namespace {

class Fit {
 public:
  Fit(const std::vector<std::array<std::int64_t, 3>>& triangles, const std::vector<Vec3>& points, const std::vector<double>& area,
      const std::vector<double>& values)
      : triangles_(triangles), points_(points), area_(area), values_(values) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto& v = triangles[t];
      normal_.push_back((points[v[1]] - points[v[0]]).cross(points[v[2]] - points[v[0]]).normalized());
      for (std::int64_t node : v) around_[node].push_back(t);
    }
  }

  double largest() const {
    double most = -INFINITY;
    for (const auto& [node, all] : around_) {
      if (values_[node] == 0) {
        most = std::max(most, 0.0);
        continue;
      }
      // An edge of the body has several sides.
      std::vector<Vec3> sides;
      for (std::size_t t : all)
        if (std::none_of(sides.begin(), sides.end(), [&](const Vec3& n) { return same_side(t, n); })) sides.push_back(normal_[t]);
      for (const Vec3& n : sides) most = std::max(most, at(node, n));
    }
    return most;
  }

 private:
  bool same_side(std::size_t t, const Vec3& n) const { return normal_[t].dot(n) > tuning::kPeakSide; }

  // Those of `nodes` and all that share a triangle of the side with them.
  std::vector<std::int64_t> grown(const std::vector<std::int64_t>& nodes, const Vec3& n) const {
    std::vector<std::int64_t> out = nodes;
    for (std::int64_t node : nodes)
      for (std::size_t t : around_.at(node))
        if (same_side(t, n)) out.insert(out.end(), triangles_[t].begin(), triangles_[t].end());
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  double at(std::int64_t node, const Vec3& n) const {
    const Vec3 across = n.unitOrthogonal(), along = n.cross(across);
    const std::vector<std::int64_t> nodes = grown(grown({node}, n), n);
    double size = 0;
    for (std::int64_t v : nodes) size = std::max(size, (points_[v] - points_[node]).norm());
    Eigen::MatrixXd A(static_cast<Eigen::Index>(nodes.size()), 6);
    Eigen::VectorXd b(A.rows());
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const std::int64_t v = nodes[static_cast<std::size_t>(i)];
      const double s = across.dot(points_[v] - points_[node]) / size, t = along.dot(points_[v] - points_[node]) / size, w = std::sqrt(area_[v]);
      A.row(i) << w, w * s, w * t, w * s * s, w * s * t, w * t * t;
      b[i] = w * values_[v];
    }
    if (A.rows() < tuning::kPeakNodes) return values_[node];
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
    return qr.rank() == 6 ? qr.solve(b)[0] : values_[node];
  }

  const std::vector<std::array<std::int64_t, 3>>& triangles_;
  const std::vector<Vec3>& points_;
  const std::vector<double>&area_, &values_;
  std::vector<Vec3> normal_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> around_;  // triangles of every node
};

}  // namespace

double smooth_peak(const std::vector<std::array<std::int64_t, 3>>& triangles, const std::vector<Vec3>& points, const std::vector<double>& area,
                   const std::vector<double>& values) {
  return Fit(triangles, points, area, values).largest();
}

}  // namespace mortise::study
