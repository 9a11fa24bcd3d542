#include "judge/stiff.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/Dense>

#include "judge/case.h"

namespace judge {
namespace {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

Vec3 eigen(const Vector& v) { return {v[0], v[1], v[2]}; }
Vec3 vector_of(const YAML::Node& n) { return {n[0].as<double>(), n[1].as<double>(), n[2].as<double>()}; }

}  // namespace

Spread stated_spread(const YAML::Node& block, const Body& body, const std::vector<Vector>& rest) {
  Mat3 R = Mat3::Identity();
  if (const YAML::Node turn = block["rotation"])
    R = Eigen::AngleAxisd(turn["angle"].as<double>(), vector_of(turn["axis"]).normalized()).toRotationMatrix();
  const YAML::Node stated = block["inertia"];
  Spread out;
  out.mass = block["mass"].as<double>();
  Vec3 centre;
  if (stated["centre"]) {
    centre = R * vector_of(stated["centre"]) + vector_of(block["position"]);
  } else {  // of the shape filled evenly: tetrahedra from the first vertex
    double filled = 0;
    centre.setZero();
    const Vector& top = rest[body.points[0]];
    for (const auto& t : body.triangles) {
      const double part = volume(top, rest[t[0]], rest[t[1]], rest[t[2]]);
      filled += part;
      centre += part / 4 * (eigen(top) + eigen(rest[t[0]]) + eigen(rest[t[1]]) + eigen(rest[t[2]]));
    }
    centre /= filled;
  }
  const Vec3 d = vector_of(stated["moments"]), o = stated["products"] ? vector_of(stated["products"]) : Vec3(0, 0, 0);
  Mat3 I;
  I << d[0], o[0], o[1], o[0], d[1], o[2], o[1], o[2], d[2];
  const Mat3 S = R * (0.5 * I.trace() * Mat3::Identity() - I) * R.transpose();
  for (int k = 0; k < 3; ++k) out.centre[k] = centre[k];
  for (int k = 0; k < 9; ++k) out.second[k] = S(k / 3, k % 3);
  return out;
}

namespace {

// Of a linear field: its gradient, and the means of places and values.
Mat3 gradient(const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& field, Vec3& X, Vec3& u) {
  X.setZero(), u.setZero();
  const double n = static_cast<double>(body.points.size());
  for (long p : body.points) X += eigen(rest[p]) / n, u += eigen(field[p]) / n;
  Mat3 A = Mat3::Zero(), B = Mat3::Zero();
  for (long p : body.points) {
    const Vec3 x = eigen(rest[p]) - X;
    A += x * x.transpose(), B += (eigen(field[p]) - u) * x.transpose();
  }
  return B * A.inverse();
}

}  // namespace

Vector turned(const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& x, const Vector& direction) {
  Vec3 X, u;
  const Vec3 out = gradient(body, rest, x, X, u) * eigen(direction);
  return {out[0], out[1], out[2]};
}

Vector at_centre(const Spread& spread, const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& field, double* square) {
  Vec3 X, u;
  const Mat3 G = gradient(body, rest, field, X, u);
  const Vec3 c = u + G * (eigen(spread.centre) - X);
  if (square) *square = spread.mass * c.squaredNorm() + (G * Eigen::Map<const Mat3>(spread.second.data()) * G.transpose()).trace();
  return {c[0], c[1], c[2]};
}

}  // namespace judge
