#include "audit/moving_body.h"

#include <algorithm>
#include <map>
#include <set>

#include "audit/archived.h"
#include "audit/entries.h"
#include "audit/holds.h"
#include "audit/tuning.h"
#include "base/disjoint_sets.h"
#include "effects/roles.h"
#include "effects/tie_name.h"

namespace mortise::audit {

MovingBodies::MovingBodies(const model::ModelInput& input) : integration_(integration_of(input.scene)) {
  const Holds holds(input.scene.at("effects"));
  const double step = integration_.step;
  std::map<std::string, std::size_t> number;
  for (const model::BodyInput& b : input.bodies)
    if (b.type != model::BodyType::half_space) number.emplace(b.name, number.size());
  std::vector<bool> tied(number.size(), false), motored(number.size(), false);
  DisjointSets sets(number.size());
  for (const auto& [one, other] : holds.together()) {
    for (const std::string& name : {one, other})
      if (number.count(name)) tied[number.at(name)] = true;
    if (number.count(one) && number.count(other) && !holds.given(one) && !holds.given(other)) sets.join(number.at(one), number.at(other));
  }
  std::set<std::string> soft;
  for (const model::BodyInput& b : input.bodies)
    if (b.type == model::BodyType::soft) soft.insert(b.name);
  std::map<std::size_t, std::size_t> carriers, bonded;  // of groups; of soft bodies
  for (const auto& [one, other] : holds.together())
    for (const auto& [carrier, body] : {std::pair{one, other}, {other, one}}) {
      if (!number.count(one) || !number.count(other) || !holds.given(carrier)) continue;
      if (!holds.given(body)) carriers.emplace(sets.of(number.at(body)), number.at(carrier));
      if (soft.count(body) && !soft.count(carrier)) bonded.emplace(number.at(body), number.at(carrier));
    }
  const std::vector<Params> joints = entries(input.scene.at("effects"), "joint");
  std::vector<bool> at_motor(number.size(), false);
  std::set<std::pair<std::string, std::string>> driven;
  for (const Params& p : joints) {
    if (holds.driven(effects::tie_name(p)) == Holds::Driven::no) continue;
    const std::string to = p.has("to") ? p.text("to") : "";
    driven.emplace(p.text("body"), to);
    for (const std::string& name : {p.text("body"), to})
      if (number.count(name)) at_motor[number.at(name)] = true;
    if (number.count(p.text("body"))) motored[sets.of(number.at(p.text("body")))] = true;
  }
  DisjointSets loose(number.size());  // kept together by what no motor moves
  for (const auto& [one, other] : holds.together())
    if (!driven.count({one, other}) && number.count(one) && number.count(other) && !holds.given(one) && !holds.given(other))
      loose.join(number.at(one), number.at(other));
  std::map<std::size_t, std::size_t> at_motors;
  for (const auto& [name, i] : number)
    if (at_motor[i] && !holds.given(name)) at_motors.emplace(loose.of(i), i);
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    const std::size_t i = number.at(b.name), group = sets.of(i);
    HowHeld how{};
    how.held = holds.held(b.name);
    how.given = holds.given(b.name), how.driven = how.given && !holds.pinned(b.name);
    how.free = !how.held && !tied[i];
    how.swings = how.held ? !how.given && !holds.motored(b.name) : !motored[group];
    how.damped = holds.damped(b.name, step), how.group = group;
    if (const auto carrier = carriers.find(group); carrier != carriers.end()) how.carrier = carrier->second;
    if (const auto to = bonded.find(i); to != bonded.end()) how.bonded = to->second;
    how.swings_with = b.type == model::BodyType::soft ? number.size() + i : loose.of(i);
    if (const auto on = at_motors.find(loose.of(i)); on != at_motors.end() && !at_motor[i] && !how.given) how.swings_on = on->second;
    std::vector<std::string> stops;
    bool spins = true;
    for (const Params& p : joints) {
      if (p.text("body") != b.name) continue;
      stops.push_back("joint/" + effects::tie_name(p) + "_stop");
      spins = spins && p.text("type") != "fixed" && !p.has("mimic") && holds.driven(effects::tie_name(p)) != Holds::Driven::yes;
    }
    how.spins = stops.empty() ? how.free : spins;
    who_.push_back({how, std::move(stops)});
  }
}

namespace {

// Of every body of `count`: the number of the one that presses it most, of half-spaces no less than `count`.
std::vector<std::size_t> pressed_by(const Snapshot& said, std::size_t count) {
  std::vector<std::map<std::size_t, double>> forces(count);
  for (const auto& [name, bodies] : said.row) {
    const auto force = said.row.find(group_of(name) + "/force");
    if (leaf_of(name) != "bodies" || force == said.row.end() || bodies.size() != 2 * force->second.size()) continue;
    for (std::size_t i = 0; i < force->second.size(); ++i)
      for (const std::size_t k : {0, 1}) {
        const auto body = static_cast<std::size_t>(bodies[2 * i + k]), other = static_cast<std::size_t>(bodies[2 * i + 1 - k]);
        if (body < count) forces[body][other] += std::abs(force->second[i]);
      }
  }
  std::vector<std::size_t> out;
  for (const auto& of : forces) {
    const auto most = std::max_element(of.begin(), of.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    out.push_back(most == of.end() ? count : most->first);
  }
  return out;
}

}  // namespace

bool soft_touches(const std::vector<MovingBody>& bodies) {
  return std::any_of(bodies.begin(), bodies.end(), [](const MovingBody& b) { return b.body.soft() && b.touches; });
}

std::vector<double> velocities(const std::vector<MovingBody>& bodies) {
  std::vector<double> out;
  for (const MovingBody& b : bodies)
    for (const Vec3& v : {b.v, b.w}) out.insert(out.end(), {v[0], v[1], v[2]});
  return out;
}

std::vector<MovingBody> MovingBodies::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MeasuredBody>& bodies) {
  std::vector<MovingBody> out;
  const Snapshot::Values *velocity = said.of_points("velocity", 3), *force = said.of_points("contact_force", 3);
  if (!velocity || velocity->empty()) return out;
  const std::vector<std::size_t> by = pressed_by(said, bodies.size());
  past_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MeasuredBody& b = bodies[i];
    double pushed = 0;
    Vec3 pressed = Vec3::Zero(), push = Vec3::Zero();
    for (std::size_t p = b.first; force && !force->empty() && p < b.first + b.count; ++p) {
      const double size = audit::at(*force, p).norm();
      pushed += size, pressed += size * audit::at(points, p), push += audit::at(*force, p);
    }
    if (pushed > 0) pressed /= pushed;
    if (push.norm() < tuning::kOneSided * pushed) push.setZero();
    const auto at_it = [&](const std::string& stop) { return said.has(stop) && said.at(stop) != 0; };
    const bool stopped = std::any_of(who_[i].stops.begin(), who_[i].stops.end(), at_it);
    // Slides on the world are supported, across their axis.
    const HowHeld& how = who_[i].how;
    const bool led = how.given || (said.has("supports/" + b.name + "_x") && !how.held);
    const Vec3 v = b.mean(*velocity, points), w = b.spin(*velocity, points);
    Past& past = past_[i];
    const auto rate = [&](const Vec3& now, double(&of)[6]) {
      const Vec3 changes = integration_.rate_of(now, audit::at(of, 0), audit::at(of, 1), states_);
      std::copy(of, of + 3, of + 3), Eigen::Map<Vec3>(of) = now;
      return changes;
    };
    const Vec3 a = rate(v, past.v), alpha = rate(w, past.w);
    out.push_back({how, b, b.mean(points, points), v, w, a, alpha, pushed > 0, stopped, pressed, push,
                   by[i] < bodies.size() ? std::optional(by[i]) : std::nullopt, led, b.soft() ? 0.0 : b.turning_energy(*velocity, points)});
  }
  ++states_;
  return out;
}

void MovingBodies::checkpoint(Archive& archive) {
  archive_all(archive, "moving.past", past_);
  archive.io("moving.states", states_);
}

double radius_of_group(const std::vector<MovingBody>& bodies, const MovingBody& body, const std::vector<double>& points) {
  double radius = 0;
  for (const MovingBody& other : bodies)
    if (other.group == body.group) radius = std::max(radius, other.body.radius(body.x, points));
  return radius;
}

Integration integration_of(const Params& scene) {
  const Params &effects = scene.at("effects"), *time = scene.find("time");
  const std::vector<std::string> inertia = effects::of_role(effects, effects::Role::inertia);
  const Params* step = time ? time->find("step") : nullptr;
  if (!step || inertia.empty()) return {};
  const Params* integrator = effects.at(inertia.front()).find("integrator");
  return {step->as_number(), integrator && integrator->as_text() == "bdf2"};
}

LostInTurning lost_in_turning(double phi) { return {std::min(2 * phi * phi, 1.0), std::min(std::pow(phi, 4) / (1 + 4 * phi * phi), 1.0)}; }

Vec3 gravity_of(const Params& scene) {
  const Params& effects = scene.at("effects");
  Vec3 sum = Vec3::Zero();
  for (const std::string& load : effects::of_role(effects, effects::Role::load))
    if (effects.at(load).has("acceleration")) sum += effects.at(load).vec3("acceleration");
  return sum;
}

}  // namespace mortise::audit
