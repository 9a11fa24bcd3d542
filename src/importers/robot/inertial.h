#pragma once
#include "importers/robot/robot.h"

namespace mortise::importers {

// In the frame around the one it was in.
inline Inertial moved(Inertial in, const Pose& at) {
  in.centre = at(in.centre);
  in.tensor = at.R * in.tensor * at.R.transpose();
  return in;
}

// Both as one: I = sum I_i + m_i (|r_i|^2 1 - r_i r_i^T), r_i from the common centre.
inline Inertial together(const Inertial& a, const Inertial& b) {
  const auto about = [](const Vec3& r) -> Mat3 { return r.squaredNorm() * Mat3::Identity() - r * r.transpose(); };
  Inertial out;
  out.mass = a.mass + b.mass;
  out.where = a.mass > 0 ? a.where : b.where;
  if (!(out.mass > 0)) return out;
  out.centre = (a.mass * a.centre + b.mass * b.centre) / out.mass;
  out.tensor = a.tensor + b.tensor + a.mass * about(a.centre - out.centre) + b.mass * about(b.centre - out.centre);
  return out;
}

}  // namespace mortise::importers
