#include "geometry/rigid_motion.h"

#include <Eigen/Dense>

namespace mortise::geometry {

Vec3 mean(const std::vector<Vec3>& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : points) sum += x;
  return sum / static_cast<double>(points.size());
}

Motion nearest_motion(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const Vec3 a = mean(from), b = mean(to);
  Mat3 H = Mat3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) H += (to[i] - b) * (from[i] - a).transpose();
  const Eigen::JacobiSVD<Mat3> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double turn = (svd.matrixU() * svd.matrixV().transpose()).determinant();  // -1: a reflection fits better
  Motion m;
  m.R = svd.matrixU() * Vec3(1, 1, turn < 0 ? -1 : 1).asDiagonal() * svd.matrixV().transpose();
  m.t = b - m.R * a;
  return m;
}

Mat3 turn_of_z(const Vec3& way) { return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), way).toRotationMatrix(); }

bool fixes_a_frame(const std::vector<Vec3>& points) {
  if (points.size() < 3) return false;
  const Vec3 a = mean(points);
  Mat3 C = Mat3::Zero();
  for (const Vec3& x : points) C += (x - a) * (x - a).transpose();
  const Vec3 size = Eigen::SelfAdjointEigenSolver<Mat3>(C).eigenvalues();  // ascending
  return size[1] > 1e-6 * size[2];
}

Motion nearest_motion_of_any(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  if (fixes_a_frame(from)) return nearest_motion(from, to);
  Motion shift;
  for (std::size_t i = 0; i < from.size(); ++i) shift.t += (to[i] - from[i]) / static_cast<double>(from.size());
  return shift;
}

RigidVelocity nearest_velocity(const std::vector<Vec3>& x, const std::vector<Vec3>& v) {
  if (x.empty()) return {};
  RigidVelocity out;
  for (std::size_t i = 0; i < x.size(); ++i) out.centre += x[i], out.v += v[i];
  out.centre /= static_cast<double>(x.size()), out.v /= static_cast<double>(x.size());
  Mat3 inertia = Mat3::Zero();
  Vec3 momentum = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 r = x[i] - out.centre;
    inertia += r.squaredNorm() * Mat3::Identity() - r * r.transpose();
    momentum += r.cross(v[i] - out.v);
  }
  out.w = inertia.ldlt().solve(momentum);
  return out;
}

}  // namespace mortise::geometry
