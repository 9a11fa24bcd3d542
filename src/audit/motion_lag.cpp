#include "audit/motion_lag.h"

#include <algorithm>
#include <cmath>

#include "audit/tuning.h"

namespace mortise::audit {

void MotionLag::Ways::start(const Vec3& v, double least_way) {
  for (std::vector<double>* velocities : {&v0, &v_last}) velocities->insert(velocities->end(), {v[0], v[1], v[2]});
  a_last.insert(a_last.end(), 3, 0.0);
  a0.push_back(0), least.push_back(least_way), far.push_back(0), ahead.push_back(0);
}

void MotionLag::Ways::restart(std::size_t body, const Vec3& v) {
  for (int k = 0; k < 3; ++k) v0[3 * body + k] = v_last[3 * body + k] = v[k], a_last[3 * body + k] = 0;
  a0[body] = far[body] = ahead[body] = 0;
}

void MotionLag::Ways::multiply(std::size_t body, const Vec3& velocity, double h) {
  const Vec3 dv = velocity - at(v_last, body), now = dv / h, da = now - at(a_last, body);
  const double grows = dv.dot(velocity) / velocity.squaredNorm(), more = da.dot(now) / now.squaredNorm();
  if (grows > 0 && grows < tuning::kMultiplies && more < tuning::kMultiplies && more > tuning::kAsFast * grows) ahead[body] += 0.5 * h * grows;
  for (int k = 0; k < 3; ++k) v_last[3 * body + k] = velocity[k], a_last[3 * body + k] = now[k];
}

double MotionLag::Ways::lag(std::size_t body, const Vec3& way, const Vec3& velocity, double h, long steps) {
  far[body] = std::max(far[body], way.norm());
  multiply(body, velocity, h);
  const Vec3 more = velocity - at(v0, body);
  const double gained = more.norm();
  if (steps == 1) a0[body] = gained / h;
  const double e = 0.5 * h * (gained + std::max(gained - a0[body] * h * static_cast<double>(steps), 0.0)) + velocity.norm() * ahead[body];
  return e > 0 ? e / std::max(far[body] + (more.dot(way) < 0 ? e : -e), least[body]) : 0;
}

void MotionLag::Ways::checkpoint(Archive& archive, const std::string& name) {
  for (auto [what, values] :
       {std::pair{".velocity", &v0}, {".a0", &a0}, {".least", &least}, {".far", &far}, {".v", &v_last}, {".a", &a_last}, {".ahead", &ahead}})
    archive.io(name + what, *values);
}

MotionLag::MotionLag(const model::ModelInput& input) {
  const Integration integration = integration_of(input.scene);
  if (!integration.second_order) step_ = integration.step;
}

double MotionLag::along_carrier(std::size_t i, const std::vector<MovingBody>& bodies) {
  const MovingBody& b = bodies[i];
  const std::optional<std::size_t> by = !b.free ? b.carrier : b.push.isZero() ? std::nullopt : b.on;
  if (!by) return carried_.lag[i];
  const MovingBody& carrier = bodies[*by];
  const Vec3 turns = carrier.w.cross(b.x - carrier.x);
  Vec3 there = carrier.v + turns, v = b.v - there;
  if (b.free)
    for (Vec3* of : {&there, &v}) *of -= b.push * b.push.dot(*of) / b.push.squaredNorm();
  // On what turns, directions turn too.
  if (turns.norm() > tuning::kStill * there.norm() || carried_.by[i] != static_cast<double>(*by)) {
    carried_.ways.restart(i, v);
    carried_.by[i] = static_cast<double>(*by), carried_.steps[i] = carried_.lag[i] = 0;
    for (std::vector<double>* way : {&carried_.carrier, &carried_.along}) std::fill_n(way->begin() + static_cast<std::ptrdiff_t>(3 * i), 3, 0.0);
    return 0;
  }
  // How fast pinned bodies start nobody knows: as if the first step had been like the second.
  if (!b.free && carried_.steps[i] == 0) carried_.ways.restart(i, 2 * at(carried_.ways.v0, i) - v);
  Eigen::Map<Vec3> way(carried_.carrier.data() + 3 * i), along(carried_.along.data() + 3 * i);
  way += step_ * there, along += step_ * v;
  const double lag = carried_.ways.lag(i, along, v, step_, static_cast<long>(++carried_.steps[i]));
  // Where the carrier goes less far, the way as seen from the world tells.
  return carried_.lag[i] = way.norm() > carried_.ways.far[i] ? lag : 0;
}

void MotionLag::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (std::isnan(step_) || bodies.empty()) return;
  const bool first = start_.empty();
  if (first) turned_.assign(3 * bodies.size(), 0.0);
  if (!first) ++steps_;
  value_ = first ? NAN : 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3 &x = bodies[i].x, &v = bodies[i].v, &w = bodies[i].w;
    if (first) {
      start_.insert(start_.end(), {x[0], x[1], x[2]});
      centres_.start(v, tuning::kStill * 2 * bodies[i].body.radius(x, points));
      turns_.start(w, tuning::kStill * 2);  // its rim goes a share of the body's size
      carried_.ways.start(v, tuning::kCarriedStill * 2 * bodies[i].body.radius(x, points));
      carried_.by.push_back(-1), carried_.steps.push_back(0), carried_.lag.push_back(0);
      for (std::vector<double>* way : {&carried_.carrier, &carried_.along}) way->insert(way->end(), 3, 0.0);
      continue;
    }
    for (int a = 0; a < 3; ++a) turned_[3 * i + a] += step_ * w[a];
    const double of_centre = centres_.lag(i, x - at(start_, i), v, step_, steps_), of_turning = turns_.lag(i, at(turned_, i), w, step_, steps_);
    if (!bodies[i].led) value_ = std::max({value_, of_centre, of_turning, along_carrier(i, bodies)});
  }
}

void MotionLag::checkpoint(Archive& archive) {
  archive.io("lag.start", start_);
  archive.io("lag.turned", turned_);
  centres_.checkpoint(archive, "lag.centres");
  turns_.checkpoint(archive, "lag.turns");
  carried_.ways.checkpoint(archive, "lag.carried");
  for (auto [name, of] : {std::pair{"by", &carried_.by},
                          {"steps", &carried_.steps},
                          {"carrier", &carried_.carrier},
                          {"along", &carried_.along},
                          {"lag", &carried_.lag}})
    archive.io(std::string("lag.carried.") + name, *of);
  archive.io("lag.steps", steps_);
  archive.io("lag.value", value_);
}

}  // namespace mortise::audit
