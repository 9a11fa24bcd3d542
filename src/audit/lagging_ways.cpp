#include "audit/lagging_ways.h"

#include <algorithm>

#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

void LaggingWays::start(const Vec3& v, double least_way) {
  for (std::vector<double>* velocities : {&v0_, &v_last_}) velocities->insert(velocities->end(), {v[0], v[1], v[2]});
  a_last_.insert(a_last_.end(), 3, 0.0);
  a0_.push_back(0), least_.push_back(least_way), far_.push_back(0), ahead_.push_back(0);
}

void LaggingWays::restart(std::size_t body, const Vec3& v) {
  for (int k = 0; k < 3; ++k) v0_[3 * body + k] = v_last_[3 * body + k] = v[k], a_last_[3 * body + k] = 0;
  a0_[body] = far_[body] = ahead_[body] = 0;
}

Vec3 LaggingWays::v0(std::size_t body) const { return at(v0_, body); }

void LaggingWays::multiply(std::size_t body, const Vec3& velocity, double h) {
  const Vec3 dv = velocity - at(v_last_, body), now = dv / h, da = now - at(a_last_, body);
  const double grows = dv.dot(velocity) / velocity.squaredNorm(), more = da.dot(now) / now.squaredNorm();
  if (grows > 0 && grows < tuning::kMultiplies && more < tuning::kMultiplies && more > tuning::kAsFast * grows) ahead_[body] += 0.5 * h * grows;
  for (int k = 0; k < 3; ++k) v_last_[3 * body + k] = velocity[k], a_last_[3 * body + k] = now[k];
}

double LaggingWays::lag(std::size_t body, const Vec3& way, const Vec3& velocity, double h, long steps) {
  far_[body] = std::max(far_[body], way.norm());
  multiply(body, velocity, h);
  const Vec3 more = velocity - v0(body);
  const double gained = more.norm();
  if (steps == 1) a0_[body] = gained / h;
  const double e = 0.5 * h * (gained + std::max(gained - a0_[body] * h * static_cast<double>(steps), 0.0)) + velocity.norm() * ahead_[body];
  return e > 0 ? e / std::max(far_[body] + (more.dot(way) < 0 ? e : -e), least_[body]) : 0;
}

void LaggingWays::checkpoint(Archive& archive, const std::string& name) {
  for (auto [what, values] :
       {std::pair{".velocity", &v0_}, {".a0", &a0_}, {".least", &least_}, {".far", &far_}, {".v", &v_last_}, {".a", &a_last_}, {".ahead", &ahead_}})
    archive.io(name + what, *values);
}

}  // namespace mortise::audit
