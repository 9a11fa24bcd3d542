#include "effects/mortar_contact/stiffness.h"

#include <cmath>

#include "effects/contact/barrier.h"
#include "effects/contact/layer.h"

namespace mortise::effects::mortar {
namespace {

double compliance(const model::Model& model, Index body) {
  if (body >= static_cast<Index>(model.bodies.size()) || model.bodies[body].type != model::BodyType::soft) return 0;
  return contact::compliance(model.bodies[body].youngs_modulus, model.bodies[body].poisson_ratio);
}

}  // namespace

Interface interface_of(const model::Model& model, Index slave, Index master) {
  Interface out{slave, master, 0, 0};
  const double sum = compliance(model, slave) + compliance(model, master);
  if (sum > 0) out.modulus = 1 / sum;
  const std::vector<Triangle> triangles = model.surface.triangles.download();
  const std::vector<Vec3> rest = model.rest_points.download();
  const model::Body& body = model.bodies[slave];
  double length = 0;
  for (Index t = body.triangle_begin; t < body.triangle_end; ++t)
    for (int k = 0; k < 3; ++k) length += (rest[triangles[t].v[k]] - rest[triangles[t].v[(k + 1) % 3]]).norm();
  out.h = length / (3.0 * (body.triangle_end - body.triangle_begin));
  return out;
}

std::vector<double> edges(const model::Model& model) {
  const std::vector<Vec3> rest = model.rest_points.download();
  std::vector<double> out;
  for (const Triangle& t : model.surface.triangles.download()) {
    double length = 0;
    for (int k = 0; k < 3; ++k) length += (rest[t.v[k]] - rest[t.v[(k + 1) % 3]]).norm();
    out.push_back(length / 3);
  }
  return out;
}

Fit between(const Fit& a, const Fit& b, double s) {
  if (s == 0 || s == 1) return s == 0 ? a : b;  // without rounding
  const double kappa = a.kappa + s * (b.kappa - a.kappa), guard = a.guard() + s * (b.guard() - a.guard());
  return {kappa, std::sqrt(7 * guard / kappa)};
}

double first_stiffness(const Interface& i, double h, double d_hat) {
  if (i.fixed) return i.modulus;
  return wanted_stiffness(i, h, d_hat, i.modulus > 0 ? tuning::kFirstPressure * i.modulus : tuning::kRigidPressure, tuning::kSoftest);
}

double wanted_stiffness(const Interface& i, double h, double d_hat, double p, double least_t) {
  const auto ratio = [](double t) { return barrier::second(t, 1.0) / barrier::phi(t); };
  const double wanted = tuning::kWanted * i.modulus * d_hat / (p * h);
  double lo = least_t, hi = 1 - 1e-6;  // the ratio rises from lo to hi
  if (wanted <= ratio(lo)) return p / barrier::phi(lo);
  for (int n = 0; n < 60; ++n) {
    const double t = 0.5 * (lo + hi);
    (ratio(t) < wanted ? lo : hi) = t;
  }
  return p / barrier::phi(0.5 * (lo + hi));
}

bool fits(const Interface& i, const Achieved& now, double kappa) {
  if (i.fixed) return true;
  if (i.modulus > 0) return now.k >= tuning::kWanted / 2 && now.k <= 2 * tuning::kWanted;
  const double t = barrier::phi_inverse(now.pressure / kappa);
  return t >= tuning::kRigidClosed && t <= tuning::kRigidOpen;
}

Achieved achieved(const Interface& i, double kappa, const Samples& samples) {
  double force = 0, pressure = 0, edge = 0, stiffness = 0, energy = 0;
  for (const Sample& s : samples.of_env) {
    const Pair& pair = samples.pairs[s.pair];
    if (pair.interface != samples.interface || !(s.gap < pair.d_hat)) continue;
    energy += s.weight * kappa * barrier::value(s.gap, pair.d_hat);
    if (s.kind != SampleKind::face) continue;
    const double p = -kappa * barrier::first(s.gap, pair.d_hat), f = s.weight * p, h = samples.edges[pair.slave];
    force += f, pressure += f * p, edge += f * h, stiffness += f * h * kappa * barrier::second(s.gap, pair.d_hat);
  }
  if (!(force > 0)) return {};
  return {pressure / force, edge / force, i.modulus > 0 ? stiffness / force / i.modulus : 0, energy};
}

double nearest_edge(const Samples& samples) {
  double least = INFINITY, depth = 0;
  for (const Sample& s : samples.of_env) {
    const Pair& pair = samples.pairs[s.pair];
    if (pair.interface == samples.interface && s.gap < least) least = s.gap, depth = tuning::kFirstDepth * samples.edges[pair.slave];
  }
  double weight = 0, edge = 0;
  for (const Sample& s : samples.of_env) {
    const Pair& pair = samples.pairs[s.pair];
    if (pair.interface != samples.interface || !(s.gap < least + depth)) continue;
    const double w = s.weight * (least + depth - s.gap);
    weight += w, edge += w * samples.edges[pair.slave];
  }
  return weight > 0 ? edge / weight : 0;
}

}  // namespace mortise::effects::mortar
