#include "audit/vibration_loss.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "effects/roles.h"

namespace mortise::audit {

namespace {

// By body, of a field of velocities, or of changes of them [J].
std::vector<double> energies_of(const std::vector<double>& velocity, const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  std::vector<double> out;
  for (const MovingBody& b : bodies) out.push_back(b.body.kinetic_energy(velocity, points));
  return out;
}

}  // namespace

VibrationLoss::VibrationLoss(const model::ModelInput& input, const MovingBodies& moving) : integration_(integration_of(input.scene)) {
  std::map<std::string, std::size_t> group;  // by body
  for (const model::BodyInput& body : input.bodies)
    if (body.type != model::BodyType::half_space)
      group[body.name] = moving.how(far_.size()).group, far_.push_back(0), soft_ = soft_ || body.type == model::BodyType::soft;
  counted_.assign(far_.size(), 0);
  mechanisms_.resize(far_.size());
  for (std::size_t i = 0; i < far_.size(); ++i)
    if (const HowHeld& how = moving.how(i); !how.swings || how.carrier) mechanisms_[how.group].alone = false;
  const auto works_on = [&](const std::string& body) {
    if (group.count(body)) mechanisms_[group[body]].alone = false;
  };
  const Params& effects = input.scene.at("effects");
  for (const Params& p : entries(effects, "drive"))
    if (p.has("friction") && p.number("friction") > 0)
      if (const std::optional<Params> joint = joint_named(effects, p.text("joint"))) works_on(joint->text("body"));
  for (const std::string& body : worked_on(effects)) works_on(body);
}

void VibrationLoss::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies, double stored,
                          double brought) {
  of_first_ = of_second_ = 0;
  for (Mechanism& m : mechanisms_) m.first = m.second = 0;
  if (bodies.empty()) return;
  brought_ += 2 * brought;
  const Snapshot::Values& v = *said.of_points("velocity", 3);
  const std::vector<double> now(v.begin(), v.end());
  look_how_far(said, points, bodies);
  const std::vector<double> energies = energies_of(now, points, bodies);
  const bool struck = soft_touches(bodies);
  stored_ = std::max(stored_, stored), moved_ = std::max(moved_, counted(energies, bodies, struck));
  std::vector<double> moved(mechanisms_.size(), 0.0);
  std::vector<bool> touches(mechanisms_.size(), false);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    moved[bodies[i].group] += energies[i];
    touches[bodies[i].group] = touches[bodies[i].group] || bodies[i].touches || bodies[i].stopped;
  }
  for (std::size_t g = 0; g < moved.size(); ++g) mechanisms_[g].moved = std::max(mechanisms_[g].moved, moved[g]);
  const auto lost = [&](const std::vector<double>& change, double times, double Mechanism::*to) {
    std::vector<double> energies = energies_of(change, points, bodies);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const MovingBody& b = bodies[i];
      if (b.touches && !struck && !b.body.soft()) energies[i] = b.energy_of(b.along_contact(b.body.mean(change, points)));
      if (Mechanism& m = mechanisms_[b.group]; m.alone && !touches[b.group] && counts(b, i, false)) m.*to += times * energies[i];
    }
    return times * counted(energies, bodies, struck);
  };
  std::vector<double> change = now;
  if (!v1_.empty()) {
    for (std::size_t i = 0; i < now.size(); ++i) change[i] = now[i] - v1_[i];
    of_first_ = lost(change, 2, &Mechanism::first);
  }
  if (integration_.second_order && !v0_.empty()) {
    for (std::size_t i = 0; i < now.size(); ++i) change[i] -= v1_[i] - v0_[i];
    of_second_ = lost(change, 1, &Mechanism::second);
  }
  v0_ = std::move(v1_);
  v1_ = now;
}

void VibrationLoss::look_how_far(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  const Snapshot::Values* u = said.of_points("displacement", 3);
  for (std::size_t i = 0; u && i < bodies.size(); ++i) {
    if (far_[i]) continue;
    const MeasuredBody& b = bodies[i].body;
    const double radius = radius_of_group(bodies, bodies[i], points);
    for (std::size_t p = b.first; p < b.first + b.count && !far_[i]; ++p) far_[i] = at(*u, p).norm() > tuning::kTrembles * radius;
    if (far_[i]) mechanisms_[bodies[i].group].far = true;
  }
}

bool VibrationLoss::counts(const MovingBody& b, std::size_t i, bool struck) const {
  return b.body.soft() || (!b.given && !b.damped && far_[i] && ((b.touches && struck) || !b.free));
}

double VibrationLoss::counted(const std::vector<double>& energies, const std::vector<MovingBody>& bodies, bool struck) {
  double sum = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (counts(bodies[i], i, struck)) sum += energies[i], counted_[i] = 1;
  return sum;
}

double VibrationLoss::sum(const SteadyMotion& steady) const {
  double moved = moved_;
  for (std::size_t i = 0; i < counted_.size(); ++i)
    if (counted_[i]) moved -= steady.of(i);
  return stored_ < moved ? stored_ / moved * sum_ : sum_;
}

void VibrationLoss::step(bool first_order, bool counts) {
  const bool second = integration_.second_order && !first_order;
  const double loss = second ? of_second_ : of_first_, struck = std::min(loss, brought_);
  brought_ -= struck;
  if (counts) sum_ += loss - struck;
  for (Mechanism& m : mechanisms_) m.sum += second ? m.second : m.first;
}

bool VibrationLoss::nothing_moves() const {
  return !soft_ && std::none_of(far_.begin(), far_.end(), [](std::uint8_t far) { return far != 0; });
}

double VibrationLoss::alone(double all) const {
  double most = 0;
  for (const Mechanism& m : mechanisms_)
    if (m.far && m.alone && m.moved > 0 && m.moved < 0.5 * all) most = std::max(most, m.sum / m.moved);
  return most;
}

void VibrationLoss::checkpoint(Archive& archive) {
  archive.io("vibration.v1", v1_);
  archive.io("vibration.v0", v0_);
  for (auto [name, value] : {std::pair{"brought", &brought_}, {"sum", &sum_}, {"stored", &stored_}, {"moved", &moved_}})
    archive.io(std::string("vibration.") + name, *value);
  for (auto [name, flags] : {std::pair{"vibration.far", &far_}, {"vibration.counted", &counted_}}) {
    std::vector<double> values(flags->begin(), flags->end());
    archive.io(name, values);
    if (archive.loading()) flags->assign(values.begin(), values.end());
  }
  std::vector<double> own;
  for (const Mechanism& m : mechanisms_) own.insert(own.end(), {m.sum, m.moved, m.far ? 1.0 : 0.0});
  archive.io("vibration.own", own);
  for (std::size_t g = 0; archive.loading() && 3 * g + 2 < own.size() && g < mechanisms_.size(); ++g)
    mechanisms_[g].sum = own[3 * g], mechanisms_[g].moved = own[3 * g + 1], mechanisms_[g].far = own[3 * g + 2] != 0;
}

}  // namespace mortise::audit
