#include "audit/checks.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/memory_archive.h"
#include "effects/roles.h"

namespace mortise::audit {
namespace {

using Json = nlohmann::ordered_json;
const char* outcome_of(Exit status) {
  if (status == Exit::done) return "done";
  if (status == Exit::scene) return "scene_error";
  if (status == Exit::solve) return "step_failed";
  return "other";
}

}  // namespace

Checks::Checks(const model::ModelInput& input) : energy_(input) {
  const Params& effects = input.scene.at("effects");
  contacts_ = effects::of_role(effects, effects::Role::contact);
  for (const std::string& name : effects::of_role(effects, effects::Role::inertia)) inertia_ = name;
  if (const Params* list = input.scene.find("checks"))
    for (const Params& p : list->items()) {
      Criterion c;
      c.params = p;
      c.quantity = p.text("quantity");
      if (const Params* body = p.find("body")) c.body = body->as_text();
      if (const Params* list = p.find("bodies"))
        for (const Params& one : list->items()) c.bodies.insert(one.as_text());
      if (const Params* when = p.find("when")) c.when = when->as_text();
      if (const Params* from = p.find("from")) c.from = from->as_number();
      if (const Params* until = p.find("until")) c.until = until->as_number();
      if (const Params* axis = p.find("axis")) c.axis = axis->as_text() == "size" ? 3 : axis->as_text()[0] - 'x';
      criteria_.push_back(std::move(c));
    }
  force_tolerance_ = input.scene.at("solver").number("force_tolerance");
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    bodies_.emplace_back(b, start_.size() / 3);
    for (const Vec3& x : b.nodes) start_.insert(start_.end(), x.data(), x.data() + 3);
  }
}

void Checks::Criterion::record(double v) {
  if (count++ == 0) first = v;
  last = v;
  sum += v;
  smallest = std::fmin(smallest, v), largest = std::fmax(largest, v);
  if (!std::isfinite(v)) not_finite = true;
}

bool Checks::wants(const std::string& quantity, const std::string& body) const {
  for (const Criterion& c : criteria_)
    if (c.quantity == quantity && c.body == body) return true;
  return false;
}
void Checks::record(const std::string& quantity, double v) { record(quantity, "", v); }
void Checks::record(const std::string& quantity, const std::string& body, double v) {
  for (Criterion& c : criteria_)
    if (c.quantity == quantity && c.body == body && c.bodies.empty() && c.counts(now_)) c.record(v);
}
void Checks::record(const std::string& quantity, const std::string& body, const Vec3& v) {
  for (Criterion& c : criteria_)
    if (c.quantity != quantity || !c.counts(now_))
      continue;
    else if (c.bodies.count(body))
      c.together += v, c.any = true;
    else if (c.body == body && c.bodies.empty())
      c.record(v);
}

const EnergyAudit::Result& Checks::state(const Snapshot& said, const std::vector<double>& points, double time) {
  now_ = time;
  const StateReport now{said, points};
  const EnergyAudit::Result& energy = energy_.state(now);
  if (empty()) return energy;
  double distance = INFINITY;
  for (const auto& [name, v] : said.number)
    if (name.ends_with("/min_distance")) distance = std::isnan(v) ? v : std::min(distance, v);
  if (std::isfinite(distance)) record("min_distance", distance);
  if (said.has("elasticity/det_F_min")) record("min_det_f", said.at("elasticity/det_F_min"));
  if (said.has("mortar_contact/clip_partition_defect")) record("clip_defect", said.at("mortar_contact/clip_partition_defect"));
  if (said.has(inertia_ + "/kinetic_energy")) record("kinetic_energy", said.at(inertia_ + "/kinetic_energy"));
  if (said.has(inertia_ + "/angular_momentum_x")) record("angular_momentum", "", now.vector(inertia_ + "/angular_momentum_"));
  if (said.has("balance/defect_x")) {
    const ForceBalance balance = force_balance(said);
    // Of forces that are no larger than what a step may leave unbalanced there is no share.
    record("force_balance", balance.scale > 1e3 * force_tolerance_ ? balance.defect / balance.scale : 0);
  }
  momentum(now);
  if (!std::isnan(energy.gain)) record("energy_gain", energy.gain);  // divided by the scale at the end
  for (Criterion& c : criteria_)
    if (c.quantity == "scalar" && said.has(c.params.text("value")) && c.counts(time)) c.record(said.at(c.params.text("value")));
  for (Criterion& c : criteria_) c.together = Vec3::Zero(), c.any = false;
  for (const MeasuredBody& b : bodies_) measure(b, now);
  for (Criterion& c : criteria_)
    if (c.any) c.record(c.together);
  return energy;
}

void Checks::momentum(const StateReport& now) {
  if (!now.said.has(inertia_ + "/momentum_x")) return;
  const Vec3 p = now.vector(inertia_ + "/momentum_");
  if (!momentum_first_) momentum_first_ = p;
  double size = 0;
  if (const auto* v = now.field("velocity"))
    for (const MeasuredBody& b : bodies_) size += b.mass() * b.mean(*v, now.points).norm();
  momentum_scale_ = std::max(momentum_scale_, size);
  if (momentum_scale_ > 0) record("momentum_drift", (p - *momentum_first_).norm() / momentum_scale_);
}

void Checks::step(const solver::StepReport& r) {
  now_ = r.time;
  energy_.step(r.first_order > 0);
  record("newton_iterations", r.newton);
  record("substeps", r.substeps);
  record("step_length", r.alpha);
  if (r.tolerance > 0) record("residual", r.residual / r.tolerance);
}

void Checks::measure(const MeasuredBody& b, const StateReport& now) {
  const std::vector<double>& x = now.points;
  if (wants("volume_change", b.name)) record("volume_change", b.name, b.volume_at(x) / b.rest_volume() - 1);
  if (wants("movement", b.name)) {
    double largest = 0;
    for (std::size_t i = b.first; i < b.first + b.count; ++i) largest = std::max(largest, (at(x, i) - at(start_, i)).norm());
    record("movement", b.name, largest);
  }
  if (wants("position", b.name)) record("position", b.name, b.mean(x, x));
  if (wants("displacement", b.name)) record("displacement", b.name, Vec3(b.mean(x, x) - b.mean(start_, start_)));
  if (wants("rotation", b.name)) record("rotation", b.name, b.rotation(start_, x));
  if (wants("lowest", b.name) || wants("highest", b.name)) {
    Vec3 lo = Vec3::Constant(INFINITY), hi = -lo;
    for (std::size_t i = b.first; i < b.first + b.count; ++i) lo = lo.cwiseMin(at(x, i)), hi = hi.cwiseMax(at(x, i));
    record("lowest", b.name, lo), record("highest", b.name, hi);
  }
  if (const auto* v = now.field("velocity")) {
    if (wants("velocity", b.name)) record("velocity", b.name, b.mean(*v, x));
    if (wants("spin", b.name)) record("spin", b.name, b.spin(*v, x));
  }
  Vec3 contact = Vec3::Zero(), support = Vec3::Zero(), friction = Vec3::Zero();
  bool touched = false, held = false, rubbed = false;
  for (const auto& [name, value] : now.said.number)
    for (int c = 0; c < 3; ++c) {
      const std::string tail = std::string("_") + "xyz"[c];
      for (const std::string& effect : contacts_)
        if (name == effect + "/force_" + b.name + tail) contact[c] += value, touched = true;
      if (name == "supports/" + b.name + tail) support[c] = value, held = true;
      if (name == "friction/force_" + b.name + tail) friction[c] = value, rubbed = true;
    }
  if (touched) record("contact_force", b.name, contact);
  if (held) record("support_force", b.name, support);
  if (rubbed) record("friction_force", b.name, friction);
}

void Checks::checkpoint(Archive& archive) {
  PrefixedArchive energy(archive, "energy");
  energy_.checkpoint(energy);
  archive.io("momentum_scale", momentum_scale_);
  std::vector<double> first;
  if (momentum_first_) first.assign(momentum_first_->data(), momentum_first_->data() + 3);
  archive.io("momentum_first", first);
  if (first.size() == 3) momentum_first_ = Vec3(first[0], first[1], first[2]);
  for (std::size_t i = 0; i < criteria_.size(); ++i) {
    Criterion& c = criteria_[i];
    PrefixedArchive part(archive, "criterion" + std::to_string(i));
    for (auto [name, value] : {std::pair{"first", &c.first}, {"last", &c.last}, {"least", &c.smallest}, {"most", &c.largest}, {"sum", &c.sum}})
      part.io(name, *value);
    part.io("count", c.count);
    part.io("not_finite", c.not_finite);
  }
}

double Checks::value(const Criterion& c) const {
  if (c.count == 0 || c.not_finite) return NAN;
  double v = c.last;
  if (c.when == "start") v = c.first;
  if (c.when == "mean") v = c.sum / static_cast<double>(c.count);
  if (c.when == "always") {
    const Params *near = c.params.find("near"), *above = c.params.find("above"), *below = c.params.find("below");
    // The worst: furthest from `near`, or furthest beyond the bound; between two bounds the one that is missed by more.
    if (near)
      v = std::abs(c.smallest - near->as_number()) > std::abs(c.largest - near->as_number()) ? c.smallest : c.largest;
    else if (above && below)
      v = above->as_number() - c.smallest > c.largest - below->as_number() ? c.smallest : c.largest;
    else
      v = above ? c.smallest : c.largest;
  }
  return c.quantity == "energy_gain" && energy_.result().scale > 0 ? v / energy_.result().scale : v;
}

Checks::Verdict Checks::judge(const Criterion& c, Exit status, const std::string& message) const {
  Verdict out;
  if (c.quantity == "outcome") {
    out.found = outcome_of(status);
    out.text = "outcome is " + c.params.text("is");
    out.pass = out.found == c.params.text("is");
    if (const Params* says = c.params.find("says"))
      for (const Params& piece : says->items()) {
        out.text += ", says '" + piece.as_text() + "'";
        out.pass = out.pass && message.find(piece.as_text()) != std::string::npos;
      }
    return out;
  }
  out.text = c.quantity == "scalar" ? c.params.text("value") : c.quantity;
  if (!c.body.empty()) out.text += " of " + c.body;
  for (const std::string& body : c.bodies) out.text += (body == *c.bodies.begin() ? " of " : " + ") + body;
  if (c.axis >= 0) out.text += c.axis == 3 ? " (size)" : fmt::format(" ({})", "xyz"[c.axis]);
  if (c.when != "always") out.text += ", " + c.when;
  if (std::isfinite(c.from)) out.text += fmt::format(", from {:.6g} s", c.from);
  if (std::isfinite(c.until)) out.text += fmt::format(", until {:.6g} s", c.until);
  out.value = value(c);
  out.pass = std::isfinite(out.value);
  const auto bound = [&](const char* key, bool holds) {
    out.text += fmt::format(" {} {:.6g}", key, c.params.number(key));
    out.pass = out.pass && holds;
  };
  if (c.params.has("above")) bound("above", out.value > c.params.number("above"));
  if (c.params.has("below")) bound("below", out.value < c.params.number("below"));
  if (!c.params.has("near")) return out;
  const double near = c.params.number("near");
  const double room = c.params.has("share") ? c.params.number("share") * std::abs(near) : c.params.number("tolerance");
  bound("near", std::abs(out.value - near) <= room);
  out.text += fmt::format(" +- {:.3g}", room);
  return out;
}

std::vector<Checks::Verdict> Checks::verdicts(Exit status, const std::string& message) const {
  std::vector<Verdict> out;
  for (const Criterion& c : criteria_) out.push_back(judge(c, status, message));
  return out;
}

std::string Checks::add_to(const std::string& certificate, const std::vector<Verdict>& verdicts) {
  if (verdicts.empty()) return certificate;
  Json j = Json::parse(certificate);
  j["criteria"] = Json::array();
  for (const Verdict& v : verdicts) {
    Json value = nullptr;
    if (!v.found.empty()) value = v.found;
    if (std::isfinite(v.value)) value = v.value;
    j["criteria"].push_back({{"criterion", v.text}, {"value", v.reached ? value : nullptr}, {"pass", v.reached ? Json(v.pass) : nullptr}});
  }
  return json_text(j, 1) + "\n";
}

}  // namespace mortise::audit
