#include "audit/state_audit.h"

#include <algorithm>
#include <numeric>

#include "audit/contact_figures.h"
#include "audit/tuning.h"
#include "effects/roles.h"

namespace mortise::audit {
ForceBalance force_balance(const Snapshot& said) {
  const auto sum = [&](const char* field) {
    double sum = 0;
    if (const Snapshot::Values* f = said.of_points(field, 3))
      for (std::size_t i = 0; i < f->size() / 3; ++i) sum += at(*f, i).norm();
    return sum;
  };
  // What one body holds from all sides bears no resultant; its forces act on both.
  return {std::hypot(said.at("balance/defect_x"), said.at("balance/defect_y"), said.at("balance/defect_z")),
          std::max({said.at("balance/largest"), sum("support_force"), 0.5 * sum("contact_force")})};
}

namespace {

bool at_a_stop(const Snapshot& said) {
  return std::any_of(said.number.begin(), said.number.end(), [](const auto& n) { return n.first.ends_with("_stop") && n.second != 0; });
}

}  // namespace

EnergyAudit::EnergyAudit(const model::ModelInput& input)
    : moving_(input),
      own_(input),
      lag_(input),
      given_lag_(input),
      held_weight_(input),
      facet_torque_(input),
      buckling_(input),
      bond_overlap_(input),
      given_kinks_(input),
      carried_(input),
      struck_(input),
      late_(input),
      slip_reversal_(input),
      motor_lag_(input),
      turning_(input),
      spin_(input),
      to_and_fro_(input),
      vibrations_(input, moving_),
      swings_(input),
      phase_(input),
      soft_phase_(input) {
  std::size_t first = 0;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    bodies_.emplace_back(b, first), elastic_.emplace_back(b, first);
    soft_ = soft_ && b.type == model::BodyType::soft;
    first += b.nodes.size();
  }
  const Params& effects = input.scene.at("effects");
  if (const double h = integration_of(input.scene).step; h > 0) {
    std::vector<double> rest;
    for (const model::BodyInput& b : input.bodies)
      for (const Vec3& x : b.nodes) rest.insert(rest.end(), x.data(), x.data() + 3);
    for (const MeasuredBody& b : bodies_) {
      const double v = tuning::kNoWay * b.radius(b.mean(rest, rest), rest) / h;
      least_.push_back(0.5 * b.mass() * v * v);
    }
  }
  r_.work_is_known = !effects::of_role(effects, effects::Role::inertia).empty();
  loads_ = effects::of_role(effects, effects::Role::load), contacts_ = effects::of_role(effects, effects::Role::contact);
}

const EnergyAudit::Result& EnergyAudit::state(const StateReport& now) {
  // The work of a load is counted where its potential is.
  for (const std::string& load : loads_) r_.work_is_known = r_.work_is_known && now.said.has(load + "/energy");
  const double before = r_.total, all_before = all_;
  const bool touches = contact_figures(now.said).pairs > 0 || at_a_stop(now.said);
  const std::vector<MovingBody> moving = moving_.state(now.said, now.points, bodies_);
  own_.state(moving);
  all_ = total(now);
  r_.total = all_ - turning(now);
  double lost = 0;  // to the time step
  balanced_ = points_before_.empty();
  contact_energy(now);
  if (!points_before_.empty()) {
    // The solver's own sum over the substeps counts moments too.
    const bool summed = now.said.has("supports/work");
    const double work = summed ? now.said.at("supports/work") : support_work(now);
    scale_.worked(work, r_.work_is_known), own_scale_.worked(work - own_.work(), r_.work_is_known);
    work_most_ = std::fmax(work_most_, std::abs(scale_.work()));
    if (summed) work_lag_ += now.said.at("supports/work_lag");
    if (r_.work_is_known) {
      r_.gain = (summed ? all_ - all_before : r_.total - before) - work;
      r_.largest_gain = std::fmax(r_.largest_gain, r_.gain - std::max(own_.untold(), 0.0));
      const double rubbed = std::fmax(now.said.at("friction/dissipation"), 0.0);
      lost = std::max(-r_.gain - (rubbed - rubbed_) - own_.lost(), 0.0);
      rubbed_ = rubbed;
      // Supports of soft bodies do no more than is reported; those of stiff ones do, where they are set in motion.
      const bool driven = std::abs(work) > tuning::kDriven * scale_.largest();
      balanced_ = !touched_ && !touches && (!driven || soft_);
      if (balanced_ && driven)
        vibrations_.lost(-std::min(r_.gain, 0.0));
      else if (balanced_ && !vibrations_.nothing_moves())
        free_ += std::max(-r_.gain - own_.lost(), 0.0);
    }
  }
  steady_.state(moving);
  bounces_.state(moving, lost, own_);
  moves_ = !moving.empty();
  if (moves_) scale_.holds(std::accumulate(least_.begin(), least_.end(), 0.0));
  own_scale_.holds(tuning::kDriven * scale_.largest());
  touched_ = touches;
  lag_.state(now.points, moving);
  phase_.state(moving), soft_phase_.state(now.said, now.points, moving);
  const std::vector<double> forces = forces_on(now);
  given_lag_.state(now.said, now.points, moving, forces);
  held_weight_.state(forces);
  facet_torque_.state(now.said, now.points, moving);
  buckling_.state(now.said, now.points);
  bond_overlap_.state(now.points);
  given_kinks_.state(now.said, now.points, moving, forces);
  carried_.state(now.points, moving);
  std::vector<double> elastic;
  for (std::size_t i = 0; i < moving.size(); ++i) elastic.push_back(elastic_[i].at(now.points));
  struck_.state(moving, elastic);
  late_.state(now.said, moving);
  slip_reversal_.state(now.said, moving);
  motor_lag_.state(now.said, now.points, moving);
  vibrations_.state(now.said, now.points, moving, stored_, bounces_.brought());
  swings_.state(now.said, now.points, moving, elastic);
  spin_.state(moving);
  to_and_fro_.state(now.points, moving);
  turning_.state(now.points, moving, {lost, own_, elastic, least_, own_scale_.work()});
  points_before_ = now.points;
  measured();
  return r_;
}

void EnergyAudit::step(bool first_order) {
  vibrations_.step(first_order, !balanced_);
  swings_.step(first_order);
  struck_.step(first_order);
  late_.step(first_order);
  turning_.step(first_order);
  spin_.step(first_order);
  to_and_fro_.step(first_order);
  measured();
}

void EnergyAudit::measured() {
  r_.support_work = scale_.work(),
  r_.work_lag = work_most_ > 0 ? work_lag_ / std::fmax(std::abs(scale_.work()), tuning::kWorkOfMost * work_most_) : 0;
  r_.scale = scale_.largest(), r_.own_scale = own_scale_.largest();
  r_.turnover = moves_ ? scale_.turnover() : 0, r_.loss_scale = moves_ ? scale_.turnover(steady_.sum()) : 0,
  r_.own_turnover = moves_ ? own_scale_.turnover() : 0;
  r_.at_start = pressed_first_ - pressed_least_;
  r_.motion_lag = std::fmax(lag_.value(), std::fmax(phase_.value(), soft_phase_.value())), r_.given_lag = given_lag_.value(),
  r_.held_weight = held_weight_.share(), r_.buckling = buckling_.value(), r_.bond_overlap = bond_overlap_.value(),
  r_.facet_torque = facet_torque_.share(), r_.given_kinks = given_kinks_.value(), r_.carried_force = carried_.share(), r_.struck = struck_.share(),
  r_.late_inertia = late_.share(), r_.slip_reversal = slip_reversal_.share();
  r_.motor_lag = motor_lag_.way(), r_.motor_torque_lag = motor_lag_.torque();
  r_.free_loss = free_ + bounces_.sum() + vibrations_.sum(steady_), r_.impacts = bounces_.stiff();
  r_.own_loss = std::max({bounces_.own(), vibrations_.alone(r_.loss_scale), swings_.share(), to_and_fro_.share()}),
  r_.own_impacts = bounces_.own_stiff();
  r_.turning_loss = turning_.sum(), r_.own_turning = std::max(turning_.of_its_own(), spin_.share()), r_.given_turning = turning_.given();
}

void EnergyAudit::checkpoint(Archive& archive) {
  for (auto [name, value] : {std::pair{"total", &r_.total},
                             {"gain", &r_.gain},
                             {"largest_gain", &r_.largest_gain},
                             {"all", &all_},
                             {"gravity_first", &gravity_first_},
                             {"free", &free_},
                             {"rubbed", &rubbed_},
                             {"work_lag", &work_lag_},
                             {"work_most", &work_most_},
                             {"pressed_first", &pressed_first_},
                             {"pressed_least", &pressed_least_}})
    archive.io(name, *value);
  for (auto [name, value] : {std::pair{"moves", &moves_}, {"touched", &touched_}, {"balanced", &balanced_}}) archive.io(name, *value);
  scale_.checkpoint(archive, "scale"), own_scale_.checkpoint(archive, "own_scale");
  moving_.checkpoint(archive);
  steady_.checkpoint(archive);
  own_.checkpoint(archive);
  lag_.checkpoint(archive);
  phase_.checkpoint(archive);
  soft_phase_.checkpoint(archive);
  given_lag_.checkpoint(archive);
  held_weight_.checkpoint(archive);
  facet_torque_.checkpoint(archive);
  buckling_.checkpoint(archive);
  bond_overlap_.checkpoint(archive);
  given_kinks_.checkpoint(archive);
  carried_.checkpoint(archive);
  struck_.checkpoint(archive);
  late_.checkpoint(archive);
  slip_reversal_.checkpoint(archive);
  motor_lag_.checkpoint(archive);
  turning_.checkpoint(archive);
  spin_.checkpoint(archive);
  to_and_fro_.checkpoint(archive);
  bounces_.checkpoint(archive);
  vibrations_.checkpoint(archive);
  swings_.checkpoint(archive);
  archive.io("points_before", points_before_);
  measured();
}

// What bears a weight from the start keeps its energy; what is shot apart does not.
void EnergyAudit::contact_energy(const StateReport& now) {
  double sum = 0;
  for (const std::string& contact : contacts_)
    if (now.said.has(contact + "/energy")) sum += now.said.at(contact + "/energy");
  if (std::isnan(pressed_first_)) pressed_first_ = sum;
  pressed_least_ = std::fmin(pressed_least_, sum);
}

double EnergyAudit::total(const StateReport& now) {
  double sum = 0;
  stored_ = 0;
  for (const auto& [name, v] : now.said.number) {
    const std::string leaf = leaf_of(name);
    if (leaf != "energy" && leaf != "kinetic_energy") continue;
    sum += v;
    if (name != "gravity/energy") {  // which is arbitrary up to a constant
      leaf == "energy" ? scale_.holds(v) : scale_.moves(v);
      own_scale_.holds(leaf == "energy" ? v : v - own_.kinetic());
      if (leaf == "energy") stored_ += v;
      continue;
    }
    if (std::isnan(gravity_first_)) gravity_first_ = v;
    scale_.holds(std::abs(v - gravity_first_)), own_scale_.holds(std::abs(v - gravity_first_ - own_.raised()));
  }
  return sum;
}

// Of every body: what holds it, or what touches it on all sides; where nothing tells the former, the largest force of all.
std::vector<double> EnergyAudit::forces_on(const StateReport& now) const {
  std::vector<double> out;
  const double largest = force_balance(now.said).scale;
  const auto* contact = now.field("contact_force");
  for (const MeasuredBody& b : bodies_) {
    const std::string held = "supports/" + b.name + "_";
    if (!now.said.has(held + "x")) {
      out.push_back(largest);
      continue;
    }
    double touches = 0;
    for (std::size_t i = b.first; contact && i < b.first + b.count; ++i) touches += at(*contact, i).norm();
    out.push_back(std::max(now.vector(held).norm(), touches));
  }
  return out;
}

// What a pinned body turns with is the doing of its pins, whose moment is not reported.
double EnergyAudit::turning(const StateReport& now) const {
  double sum = 0;
  if (const auto* v = now.field("velocity"))
    for (const MeasuredBody& b : bodies_)
      if (!b.soft() && now.said.has("supports/" + b.name + "_x")) sum += b.turning_energy(*v, now.points);
  return sum;
}

double EnergyAudit::support_work(const StateReport& now) const {
  double work = 0;
  const auto moved = [&](std::size_t i) { return Vec3(at(now.points, i) - at(points_before_, i)); };
  if (const auto* f = now.field("support_force"))
    for (std::size_t i = 0; i < f->size() / 3; ++i) work += at(*f, i).dot(moved(i));
  // A pinned stiff body: its resultant on the way of its centre, and against the contact on what it turns.
  const auto *contact = now.field("contact_force"), *friction = now.field("friction_force");
  for (const MeasuredBody& b : bodies_) {
    if (b.soft() || !now.said.has("supports/" + b.name + "_x")) continue;
    const Vec3 way = b.mean(now.points, now.points) - b.mean(points_before_, points_before_);
    work += now.vector("supports/" + b.name + "_").dot(way);
    for (std::size_t i = b.first; i < b.first + b.count; ++i)
      for (const auto* f : {contact, friction})
        if (f) work -= at(*f, i).dot(moved(i) - way);
  }
  return work;
}

}  // namespace mortise::audit
