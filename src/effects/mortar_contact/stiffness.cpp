#include "effects/mortar_contact/stiffness.h"

#include "effects/contact/barrier.h"
#include "effects/contact/layer.h"
#include "effects/contact/tuning.h"

namespace mortise::effects::mortar {
namespace {

double compliance(const model::Model& model, Index body) {
  if (body >= static_cast<Index>(model.bodies.size()) || model.bodies[body].type != model::BodyType::soft) return 0;
  return contact::compliance(model.bodies[body].youngs_modulus, model.bodies[body].poisson_ratio);
}

}  // namespace

Interface interface_of(const model::Model& model, Index slave, Index master, double d_hat, bool set) {
  Interface out{slave, master, model.bodies[slave].env, d_hat};
  const double sum = compliance(model, slave) + compliance(model, master);
  if (sum > 0) out.modulus = 1 / sum;
  out.fixed = !set && sum > 0;
  const std::vector<Triangle> triangles = model.surface.triangles.download();
  const std::vector<Vec3> rest = model.rest_points.download();
  const model::Body& body = model.bodies[slave];
  double length = 0;
  for (Index t = body.triangle_begin; t < body.triangle_end; ++t)
    for (int k = 0; k < 3; ++k) length += (rest[triangles[t].v[k]] - rest[triangles[t].v[(k + 1) % 3]]).norm();
  out.h = length / (3.0 * (body.triangle_end - body.triangle_begin));
  return out;
}

double first_stiffness(const Interface& i) {
  if (i.fixed) return i.modulus;
  if (i.modulus == 0) return contact::tuning::kRigid;
  return wanted_stiffness(i, tuning::kFirstPressure * i.modulus, tuning::kSoftest);
}

double wanted_stiffness(const Interface& i, double p, double least_t) {
  const auto ratio = [](double t) { return barrier::second(t, 1.0) / barrier::phi(t); };
  const double wanted = tuning::kWanted * i.modulus * i.d_hat / (p * i.h);
  double lo = least_t, hi = 1 - 1e-6;  // the ratio rises from lo to hi
  if (wanted <= ratio(lo)) return p / barrier::phi(lo);
  for (int n = 0; n < 60; ++n) {
    const double t = 0.5 * (lo + hi);
    (ratio(t) < wanted ? lo : hi) = t;
  }
  return p / barrier::phi(0.5 * (lo + hi));
}

Achieved achieved(const Interface& i, Index number, double kappa, const Taken& at) {
  double force = 0, pressure = 0, stiffness = 0, energy = 0;
  for (const Sample& s : at.of_env(i.env)) {
    const Pair& pair = at.pairs[s.pair];
    if (pair.interface != number || !(s.gap < pair.d_hat)) continue;
    energy += s.weight * kappa * barrier::value(s.gap, pair.d_hat);
    if (s.kind != SampleKind::face) continue;
    const double p = -kappa * barrier::first(s.gap, pair.d_hat), f = s.weight * p;
    force += f, pressure += f * p, stiffness += f * kappa * barrier::second(s.gap, pair.d_hat);
  }
  if (!(force > 0)) return {};
  return {pressure / force, i.modulus > 0 ? stiffness / force * i.h / i.modulus : 0, energy};
}

bool fits(const Interface& i, const Achieved& now, double kappa) {
  if (i.fixed) return true;
  if (i.modulus > 0) return now.k >= tuning::kWanted / 2 && now.k <= 2 * tuning::kWanted;
  const double t = barrier::phi_inverse(now.pressure / kappa);
  return t >= tuning::kRigidClosed;
}

}  // namespace mortise::effects::mortar
