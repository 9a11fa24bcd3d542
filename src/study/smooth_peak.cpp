#include "study/smooth_peak.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "study/tuning.h"

namespace mortise::study {
namespace {

using Around = std::unordered_map<std::int64_t, std::vector<std::int64_t>>;

using Normals = std::unordered_map<std::int64_t, Vec3>;

// The node itself and all within two edges, but for those beyond an edge of the body.
std::vector<std::int64_t> patch(const Around& around, const Normals& normal, std::int64_t node) {
  std::vector<std::int64_t> out;
  for (std::int64_t near : around.at(node)) out.insert(out.end(), around.at(near).begin(), around.at(near).end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  const Vec3 n = normal.at(node).normalized();
  std::erase_if(out, [&](std::int64_t v) { return n.dot(normal.at(v).normalized()) < tuning::kPeakSide; });
  return out;
}

}  // namespace

double smooth_peak(const std::vector<std::array<std::int64_t, 3>>& triangles, const std::vector<Vec3>& points, const std::vector<double>& area,
                   const std::vector<double>& values) {
  Around around;  // every node: it and those one edge away, some more than once
  Normals normal;
  for (const auto& t : triangles) {
    const Vec3 n = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    for (std::int64_t v : t) {
      around[v].insert(around[v].end(), t.begin(), t.end());
      normal.try_emplace(v, Vec3::Zero()).first->second += n;
    }
  }
  double most = -INFINITY;
  for (const auto& [node, n] : normal) {
    if (values[node] == 0) {
      most = std::max(most, 0.0);
      continue;
    }
    const Vec3 across = n.unitOrthogonal(), along = n.normalized().cross(across);
    const std::vector<std::int64_t> nodes = patch(around, normal, node);
    double size = 0;
    for (std::int64_t v : nodes) size = std::max(size, (points[v] - points[node]).norm());
    Eigen::MatrixXd A(static_cast<Eigen::Index>(nodes.size()), 6);
    Eigen::VectorXd b(A.rows());
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const std::int64_t v = nodes[static_cast<std::size_t>(i)];
      const double s = across.dot(points[v] - points[node]) / size, t = along.dot(points[v] - points[node]) / size, w = std::sqrt(area[v]);
      A.row(i) << w, w * s, w * t, w * s * s, w * s * t, w * t * t;
      b[i] = w * values[v];
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
    const bool enough = A.rows() >= tuning::kPeakNodes && qr.rank() == 6;
    most = std::max(most, enough ? qr.solve(b)[0] : values[node]);
  }
  return most;
}

}  // namespace mortise::study
