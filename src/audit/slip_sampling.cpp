#include "audit/slip_sampling.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

SlipSampling::SlipSampling(const model::ModelInput& input) : rubs_(!friction_laws(input).empty()) {
  std::size_t first = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    bodies_.push_back({first, body.nodes, body.triangles});
    first += body.nodes.size();
  }
}

struct SlipSampling::Fields {
  std::span<const double> displacement, velocity, contact;
};

namespace {

// Mean length, over a triangle, of what is linear in it with the corner values v: of the middles of its n^2 parts.
double mean_length(const Vec3 v[3]) {
  constexpr int n = 8;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const auto add = [&](double a, double b) { sum += (v[0] + a / n * (v[1] - v[0]) + b / n * (v[2] - v[0])).norm(); };
      add(i + 1.0 / 3, j + 1.0 / 3);
      if (i + j < n - 1) add(i + 2.0 / 3, j + 2.0 / 3);
    }
  return sum / (n * n);
}

}  // namespace

geometry::RigidVelocity SlipSampling::rigid(std::size_t body, const Fields& f) const {
  std::vector<Vec3> x, v;
  for (std::size_t i = 0; body < bodies_.size() && i < bodies_[body].rest.size(); ++i) {
    const std::size_t p = bodies_[body].first + i;
    x.push_back(bodies_[body].rest[i] + at(f.displacement, p)), v.push_back(at(f.velocity, p));
  }
  return geometry::nearest_velocity(x, v);
}

SlipSampling::Slip SlipSampling::slip_on(std::size_t body, const geometry::RigidVelocity& own, const geometry::RigidVelocity& under,
                                         const Fields& f) const {
  if (body >= bodies_.size()) return {};
  const Body& b = bodies_[body];
  struct Face {
    const Index* v;
    double area;
    Vec3 n;
  };
  std::vector<Face> faces;
  std::vector<double> area(b.rest.size(), 0.0);  // of those at a node
  const auto place = [&](Index i) { return Vec3(b.rest[i] + at(f.displacement, b.first + i)); };
  for (const Triangle& t : b.triangles) {
    const Vec3 twice = (place(t.v[1]) - place(t.v[0])).cross(place(t.v[2]) - place(t.v[0])), n = twice.normalized();
    const bool bears = std::all_of(t.v, t.v + 3, [&](Index i) {
      const Vec3 force = at(f.contact, b.first + i);
      return -force.dot(n) > tuning::kFacing * force.norm();
    });
    if (!bears) continue;
    faces.push_back({t.v, 0.5 * twice.norm(), n});
    for (const Index i : t.v) area[i] += faces.back().area;
  }
  double force = 0, corners = 0, inside = 0, all = 0;
  for (std::size_t i = 0; i < b.rest.size(); ++i) all += at(f.contact, b.first + i).norm();
  for (const Face& face : faces) {
    double P = 0, mean = 0;
    Vec3 u[3];
    for (int k = 0; k < 3; ++k) {
      const Index i = face.v[k];
      const double f_k = face.area / area[i] * at(f.contact, b.first + i).norm();
      const Vec3 x = place(i), against = own.at(x) - under.at(x);
      u[k] = against - against.dot(face.n) * face.n;
      P += f_k, corners += f_k * u[k].norm(), mean += u[k].norm() / 3;
    }
    force += P, inside += P * (mean - mean_length(u));
  }
  if (!(force > tuning::kBearing * all)) return {};
  return {corners / force, (corners - inside) / force};
}

void SlipSampling::state(const Snapshot& said, const std::vector<Rubbing>& rubs) {
  for (auto& [bodies, pair] : pairs_) pair.power = 0;
  const Fields f{of_points(said, "displacement", 3), of_points(said, "velocity", 3), of_points(said, "contact_force", 3)};
  if (f.displacement.empty() || f.velocity.size() != f.displacement.size() || f.contact.size() != f.displacement.size()) return;
  std::map<std::size_t, geometry::RigidVelocity> rigid;  // of what slips
  const auto rigid_of = [&](std::size_t body) -> const geometry::RigidVelocity& {
    const auto [it, first] = rigid.try_emplace(body);
    if (first) it->second = this->rigid(body, f);
    return it->second;
  };
  for (const Rubbing& rub : rubs)
    for (const auto& [bodies, of] : rub) {
      if (of.stuck > tuning::kSticks * of.power) continue;
      Pair& pair = pairs_[bodies];
      pair.error = INFINITY, pair.power = of.power;
      for (const auto& [one, other] : {bodies, Bodies{bodies.second, bodies.first}})
        if (const Slip slip = slip_on(one, rigid_of(one), rigid_of(other), f); slip.faces > 0)
          pair.error = std::min(pair.error, std::max(0.0, std::min(slip.corners, of.pressed_speed()) / slip.faces - 1));
      if (!std::isfinite(pair.error)) pair.error = 0;
    }
}

void SlipSampling::step(double dt) {
  for (auto& [bodies, pair] : pairs_) pair.taken += dt * pair.power, pair.wrong += dt * pair.power * pair.error;
}

double SlipSampling::share() const {
  if (!rubs_) return NAN;
  double all = 0, most = 0;
  for (const auto& [bodies, pair] : pairs_) all += pair.taken;
  for (const auto& [bodies, pair] : pairs_)
    if (pair.taken > tuning::kPart * all) most = std::max(most, pair.wrong / pair.taken);
  return most;
}

void SlipSampling::checkpoint(Archive& archive) {
  std::vector<double> of;
  for (const auto& [bodies, pair] : pairs_)
    of.insert(of.end(), {static_cast<double>(bodies.first), static_cast<double>(bodies.second), pair.wrong, pair.taken, pair.error, pair.power});
  archive.io("slip_sampling.pairs", of);
  if (!archive.loading()) return;
  pairs_.clear();
  for (std::size_t i = 0; i + 5 < of.size(); i += 6)
    pairs_[{static_cast<std::size_t>(of[i]), static_cast<std::size_t>(of[i + 1])}] = {of[i + 2], of[i + 3], of[i + 4], of[i + 5]};
}

}  // namespace mortise::audit
