#include "scene/checks.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "scene/suggest.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;
using namespace param;

// What can be measured: once per state or step of the run, of one body or of all, a number or a component of a vector.
struct Measure {
  const char* name;
  Unit unit;
  bool body, vector;
  const char* needs;  // the effect that it is measured on; "contact", "inertia": any effect of that role
  const char* help;
};
constexpr Measure kMeasures[] = {
    {"min_distance", Unit::length, false, false, "contact", "Smallest distance that the contact effects see; their d_hat where nothing is nearer."},
    {"min_det_f", Unit::none, false, false, "elasticity", "Smallest determinant of the deformation gradient."},
    {"kinetic_energy", Unit::energy, false, false, "inertia", "Kinetic energy of all bodies."},
    {"energy_gain", Unit::none, false, false, "inertia",
     "Energy gained in a step beyond the work of moving supports, as a share of the largest energy of the run."},
    {"momentum_drift", Unit::none, false, false, "inertia", "Change of linear momentum since the start over the largest sum of mass times speed."},
    {"angular_momentum", Unit::none, false, true, "inertia", "Angular momentum of all bodies about the origin [kg m^2/s]."},
    {"force_balance", Unit::none, false, false, "",
     "Sum of all forces over the largest force of one effect on one body or, where larger, the sum of the supports' forces on points."},
    {"clip_defect", Unit::none, false, false, "mortar_contact",
     "Largest difference between a covered face and the sum of its pieces, as a share of the face."},
    {"newton_iterations", Unit::none, false, false, "", "Newton iterations of a step."},
    {"substeps", Unit::none, false, false, "", "Parts into which a step was halved."},
    {"step_length", Unit::none, false, false, "", "Smallest accepted share of a Newton step."},
    {"residual", Unit::none, false, false, "", "Largest force residual over what it had to be below."},
    {"volume_change", Unit::none, true, false, "", "Volume over its volume at the start, less one."},
    {"movement", Unit::length, true, false, "", "Largest distance of any point from where it started."},
    {"position", Unit::length, true, true, "", "Centre of mass."},
    {"displacement", Unit::length, true, true, "", "Way of the centre of mass since the start."},
    {"rotation", Unit::angle, true, true, "",
     "Rotation since the start, of the rigid motion that fits the points best: its angle along its axis; size: the angle, at most half a turn "
     "(beyond, the other way; joint/NAME_angle of quantities counts on)."},
    {"lowest", Unit::length, true, true, "", "Lowest coordinate of any point along the axis."},
    {"highest", Unit::length, true, true, "", "Highest coordinate of any point along the axis."},
    {"velocity", Unit::velocity, true, true, "inertia", "Velocity of the centre of mass."},
    {"spin", Unit::angular_velocity, true, true, "inertia", "Angular velocity of the rigid motion that fits the points' velocities best."},
    {"contact_force", Unit::force, true, true, "contact", "Force of all contact effects on the body."},
    {"friction_force", Unit::force, true, true, "friction", "Friction on the body."},
    {"support_force", Unit::force, true, true, "pin", "Force of its pins on the body (of joints: scalar, joint/NAME_force_z)."},
    {"scalar", Unit::any, false, false, "",
     "What `value` names: all that the field file has as one number, as for `quantities`; of sensors, in frames."},
};

const Measure* find_measure(const std::string& name) {
  const auto it = std::find_if(std::begin(kMeasures), std::end(kMeasures), [&](const Measure& q) { return name == q.name; });
  return it == std::end(kMeasures) ? nullptr : it;
}

Param quantity_param() {
  std::vector<std::string> names;
  for (const Measure& q : kMeasures) names.push_back(q.name);
  names.push_back("outcome");
  return required(choice("quantity", names, "", "What is measured; outcome: how the run ends."));
}

ParamTable table_of(const Measure& q) {
  ParamTable t{"check", std::string(q.name) + ": " + q.help, {quantity_param()}};
  if (q.unit == Unit::any)
    t.params.push_back(required(of(Kind::text, "value", Unit::none, {}, "group/name of the scalar: joint/hinge_force_z, sensor_skin/force_z.")));
  if (q.body && q.unit == Unit::force) {
    t.params.push_back(optional(of(Kind::text, "body", Unit::none, {}, "Name of the body.")));
    t.params.push_back(optional(of(Kind::names, "bodies", Unit::none, {}, "Or the names of several, whose forces are added up.")));
  } else if (q.body) {
    t.params.push_back(of(Kind::text, "body", Unit::none, {}, "Name of the body."));
  }
  if (q.vector) t.params.push_back(required(choice("axis", {"x", "y", "z", "size"}, "", "Component; size: length of the vector.")));
  t.params.push_back(choice("when", {"always", "start", "end", "mean"}, "always",
                            "always: at every state and step; start, end: in the first or last one; mean: of all of them."));
  t.params.push_back(optional(of(Kind::number, "from", Unit::time, {}, "Only of steps and states later than this.")));
  t.params.push_back(optional(of(Kind::number, "until", Unit::time, {}, "Only of steps and states no later than this.")));
  t.params.push_back(optional(of(Kind::number, "above", q.unit, {}, "Must be larger.")));
  t.params.push_back(optional(of(Kind::number, "below", q.unit, {}, "Must be smaller.")));
  t.params.push_back(optional(of(Kind::number, "near", q.unit, {}, "Must differ from this by no more than `tolerance` or `share`.")));
  t.params.push_back(
      range(optional(of(Kind::number, "tolerance", q.unit, {}, "Largest difference from `near`.")), 0, std::numeric_limits<double>::infinity()));
  t.params.push_back(range(optional(of(Kind::number, "share", Unit::none, {}, "Largest difference from `near`, as a share of it.")), 0,
                           std::numeric_limits<double>::infinity()));
  return t;
}

const ParamTable& outcome_table() {
  static const ParamTable t{
      "check of outcome",
      "How the run ends; without this check it has to end well.",
      {quantity_param(),
       required(choice("is", {"done", "scene_error", "step_failed"}, "",
                       "done: all steps; scene_error: the scene is refused (exit code 3); step_failed: a step has no solution (exit code 5).")),
       optional(of(Kind::names, "says", Unit::none, {}, "Pieces of text that the error message contains."))}};
  return t;
}

class Checks {
 public:
  Checks(const Params& root, std::span<const EffectTable> tables, const std::set<std::string>& incomplete, Diagnostics& errors)
      : errors_(errors), tables_(tables), incomplete_(incomplete), bodies_(root.find("bodies")), effects_(root.find("effects")) {
    const Params* time = incomplete.count("time") ? nullptr : root.find("time");
    if (time && time->has("mode") && (time->text("mode") == "static" || (time->has("step") && time->has("steps")))) end_ = end_time(root);
  }

  void check(const Params& c, const std::string& path) {
    const Params* name = c.find("quantity");
    if (!name || name->as_text() == "outcome") return;
    const Measure* q = find_measure(name->as_text());
    if (!q) return;
    bounds(c, path);
    const Params *body = c.find("body"), *bodies = c.find("bodies"), *from = c.find("from"), *until = c.find("until");
    if (body) this->body(*body, path);
    if (bodies)
      for (const Params& one : bodies->items()) this->body(one, path);
    if (body && bodies) errors_.add(bodies->where(), path + " has body and bodies; write one of them");
    if (q->body && !body && !bodies && !incomplete_.count(path)) errors_.add(c.where(), path + " names no body", "give it body or bodies");
    if (from && until && !(from->as_number() < until->as_number())) errors_.add(until->where(), path + ".until must be later than its from");
    if (from && !(from->as_number() < end_ * (1 - 1e-9)))
      errors_.add(from->where(), path + ".from: the scene ends at " + format_number(end_) + " s, and nothing is measured after that",
                  "--frames N ends a run earlier without a change of the scene, and leaves such checks undecided");
    needs(*q, *name, path);
    if (q->name == std::string("energy_gain")) without({"pressure_load"}, *name, path, "which does work that is not counted");
    if (q->name == std::string("momentum_drift")) without({"gravity", "pin", "pressure_load"}, *name, path, "which changes momentum");
  }

 private:
  void bounds(const Params& c, const std::string& path) {
    const Params *above = c.find("above"), *below = c.find("below"), *near = c.find("near"), *tolerance = c.find("tolerance"),
                 *share = c.find("share");
    if (incomplete_.count(path)) return;
    if (!above && !below && !near) errors_.add(c.where(), path + " has no bound", "give it above, below, or near with tolerance or share");
    if (near && !tolerance && !share) errors_.add(near->where(), path + ".near needs a tolerance", "write tolerance (absolute) or share (relative)");
    if (near && tolerance && share) errors_.add(share->where(), path + " has tolerance and share; write one of them");
    for (const Params* p : {tolerance, share})
      if (p && !near) errors_.add(p->where(), path + " has a tolerance but nothing to be near");
    if (share && near && near->as_number() == 0) errors_.add(share->where(), path + ": a share of zero is zero", "use tolerance");
    if (above && below && !(above->as_number() < below->as_number())) errors_.add(below->where(), path + ": nothing is above and below these");
  }

  void body(const Params& name, const std::string& path) {
    if (!bodies_ || incomplete_.count("bodies")) return;
    if (const Params* found = bodies_->find(name.as_text())) {
      const Params* type = found->find("type");
      if (type && type->as_text() == "half_space")
        errors_.add(name.where(), path + ".body: half-space '" + name.as_text() + "' has nothing to measure", "name a soft or stiff body");
      return;
    }
    std::vector<std::string> names;
    for (const auto& [key, value] : bodies_->entries()) names.push_back(key);
    errors_.add(name.where(), path + ".body: no body '" + name.as_text() + "'", suggestion(name.as_text(), names));
  }

  void needs(const Measure& q, const Params& at, const std::string& path) {
    if (!effects_ || incomplete_.count("effects") || !*q.needs) return;
    const std::string wanted = q.needs;
    if (effects_->has(wanted)) return;
    for (const EffectTable& t : tables_)
      if (effects_->has(t.name) && ((t.contact && wanted == "contact") || (t.inertia && wanted == "inertia"))) return;
    errors_.add(at.where(),
                path + ": " + q.name + " is measured on " + (wanted == "contact" ? "a contact effect" : "the effect '" + wanted + "'") +
                    ", which the scene does not list",
                "", {{effects_->where(), "the effects"}});
  }

  void without(const std::vector<std::string>& effects, const Params& at, const std::string& path, const std::string& why) {
    if (!effects_) return;
    for (const std::string& name : effects)
      if (const Params* effect = effects_->find(name))
        errors_.add(at.where(), path + ": " + at.as_text() + " means nothing in a scene with " + name + ", " + why, "", {{effect->where(), "here"}});
  }

  Diagnostics& errors_;
  std::span<const EffectTable> tables_;
  const std::set<std::string>& incomplete_;
  const Params *bodies_, *effects_;
  double end_ = std::numeric_limits<double>::infinity();  // of the scene [s], where it is known
};

}  // namespace

const ParamTable& check_table() {
  static const ParamTable t{"check", "One criterion; its keys depend on `quantity`.", {quantity_param()}};
  return t;
}

const Variants& check_variants() {
  // Quantities that take the same keys share a table, or the schema would be very long.
  static const Variants variants = [] {
    static std::map<std::tuple<Unit, bool, bool>, ParamTable> tables;
    Variants v{&check_table(), "quantity", {}};
    for (const Measure& q : kMeasures) {
      const auto [at, fresh] = tables.try_emplace({q.unit, q.body, q.vector}, table_of(q));
      if (!fresh) at->second.help += std::string(" ") + q.name + ": " + q.help;
      v.of.emplace_back(q.name, &at->second);
    }
    v.of.emplace_back("outcome", &outcome_table());
    return v;
  }();
  return variants;
}

void check_checks(const Params& root, std::span<const EffectTable> effects, const std::set<std::string>& incomplete, Diagnostics& errors) {
  const Params* list = root.find("checks");
  if (!list) return;
  Checks checks(root, effects, incomplete, errors);
  for (std::size_t i = 0; i < list->items().size(); ++i) checks.check(list->items()[i], "checks." + std::to_string(i));
}

}  // namespace mortise::scene
