#include "study/error_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "audit/vector_at.h"
#include "base/cpu_time.h"
#include "effects/roles.h"
#include "engine/effect_tables.h"
#include "run/output_mesh.h"
#include "run/signals.h"
#include "scene/scene.h"
#include "study/blind.h"
#include "study/course.h"
#include "study/followed_budget.h"
#include "study/measure.h"
#include "study/read.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

// Number of a body among those that move or are held (half-spaces are none); -1 where there is no such.
int body_of(const model::ModelInput& input, const std::string& name) {
  int i = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    if (body.name == name) return i;
    ++i;
  }
  return -1;
}

constexpr const char* kKnown =
    "its gradient is not known: there are supports/BODY_x (y, z), and displacement and position along an axis, at a point or as max or min";

// The gradient of a quantity of the last state, or why there is none.
struct Gradient {
  solver::Functional of;
  std::string why_not;
  double scale = 0;  // see QuantityBudget
};

// What supports hold a body with, or the points of a soft one, summed without regard to direction [N].
double held_with(const model::ModelInput& input, const std::string& name, const Snapshot& state) {
  double square = 0, sum = 0;
  for (const char* tail : {"_x", "_y", "_z"})
    if (const double f = state.at("supports/" + name + tail); std::isfinite(f)) square += f * f;
  std::size_t point = 0;
  const Snapshot::Values* force = state.of_points("support_force", 3);
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    for (std::size_t i = 0; i < body.nodes.size() && force && body.name == name; ++i) sum += audit::at(*force, point + i).norm();
    point += body.nodes.size();
  }
  return std::fmax(std::sqrt(square), sum);
}

double longest(const std::vector<Vec3>& rest, const std::vector<double>& points) {
  double out = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) out = std::max(out, (audit::at(points, i) - rest[i]).norm());
  return out;
}

Gradient gradient_of(const Quantity& q, const model::ModelInput& input, const Snapshot& state, const std::vector<double>& points) {
  Gradient out;
  const auto none = [&](const std::string& why) { return out.why_not = why, out; };
  if (q.when != "end" || q.at) return none("it is not of the last state");
  const std::string axes = "xyz";
  if (group_of(q.value) == "supports") {
    std::string body = leaf_of(q.value), axis = q.axis;
    if (axis.empty() && body.size() > 2 && body[body.size() - 2] == '_') axis = body.back(), body.resize(body.size() - 2);
    out.of.body = axis.size() == 1 && axes.find(axis) != std::string::npos ? body_of(input, body) : -1;
    if (out.of.body < 0) return none(kKnown);
    out.of.axis = static_cast<int>(axes.find(axis));
    out.scale = held_with(input, body, state);
    return out;
  }
  if ((q.value != "displacement" && q.value != "position") || q.axis.size() != 1) return none(kKnown);
  const output::OutputMesh mesh = run::output_mesh(input);
  const auto axis = axes.find(q.axis);
  out.scale = longest(mesh.points, points);
  out.of.points.assign(points.size(), 0.0);
  if (q.point) {
    for (const auto& [i, w] : weights_at(mesh, q)) out.of.points[3 * i + axis] = w;
    return out;
  }
  if (q.over != "max" && q.over != "min") return none(kKnown);
  const int body = body_of(input, q.body);
  std::size_t best = SIZE_MAX;
  double most = -INFINITY;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (mesh.body_of_point[i] != body) continue;
    const double x = points[3 * i + axis] - (q.value == "displacement" ? mesh.points[i][static_cast<int>(axis)] : 0);
    if (const double v = q.over == "max" ? x : -x; v > most) most = v, best = i;
  }
  if (best == SIZE_MAX) return none("no such body has points");
  out.of.points[3 * best + axis] = 1;
  return out;
}

// A point that lies nowhere is a reason too: it does not undo hours of work.
Gradient known_gradient(const Quantity& q, const model::ModelInput& input, const Snapshot& state, const std::vector<double>& points) try {
  return gradient_of(q, input, state, points);
} catch (const Error& e) {
  return {{}, e.what()};
}

constexpr const char* kFollowed = ", as mortise study --error-budget does";

// Why the last state does not tell what errors do to a scene; empty where it does.
std::string why_none(const Params& scene) {
  const Params& time = scene.at("time");
  if (time.text("mode") != "static") return "in motion the errors of all steps add up, and they have to be followed";
  if (!effects::of_role(scene.at("effects"), effects::Role::follower).empty() && time.integer("steps") > 1)
    return "with friction what stuck in earlier load steps counts, and they have to be followed";
  return "";
}

// Shear and changes of volume, where they are nearly as much one way as the other.
double hidden_in(const solver::Adjoint& adjoint) {
  const double shear = adjoint.mesh - adjoint.volumes, volumes = adjoint.volumes;
  const double less = std::min(std::abs(shear), std::abs(volumes)), more = std::max(std::abs(shear), std::abs(volumes));
  return shear * volumes < 0 && less > tuning::kHides * more ? less + more : 0;
}

}  // namespace

void QuantityBudget::judge(double of_value) {
  value = of_value;
  for (ErrorPart& part : parts) {
    if (part.hidden > 0) part.error = std::copysign(part.hidden, part.error);
    part.found = part.error;
    if (part.hidden > tuning::kHiddenShare * std::abs(value)) {
      part.why_not = fmt::format(
          "{}: elements are too stiff in shear and too soft in what changes volumes, {:.2g} % of the number together, and one hides the other",
          kNotReliable, 100 * std::abs(part.error / value));
      part.error = NAN;
    }
    if (part.source != kMeshPart || !(std::abs(part.error) > tuning::kCoarseShare * std::abs(value))) continue;
    part.why_not = fmt::format("{}: the mesh is too coarse for it ({:.2g} % of the number was found, and above {:g} % up to half is missed)",
                               kNotReliable, 100 * std::abs(part.error / value), 100 * tuning::kCoarseShare);
    part.error = NAN;
  }
}

double QuantityBudget::sum() const {
  double out = 0;
  for (const ErrorPart& part : parts) out += std::isfinite(part.error) ? part.error : 0;
  return out;
}

double QuantityBudget::share() const {
  double found = 0;
  bool any = false;
  for (const ErrorPart& part : parts)
    if (std::isfinite(part.found)) found += part.found, any = true;
  const double of = std::max(std::abs(value), tuning::kSmallest * scale);
  return any && of > 0 ? std::abs(found) / of : NAN;
}

bool QuantityBudget::complete() const {
  return std::all_of(parts.begin(), parts.end(), [](const ErrorPart& p) { return std::isfinite(p.error); });
}

std::string what_lies_between(double share) {
  if (!(std::abs(share) > 0)) return "";
  return fmt::format("{}between steps it may be {:.2g} % off that value",
                     std::abs(share) > tuning::kPeakShare ? std::string(kNotReliable) + ": " : "", 100 * std::abs(share));
}

ErrorBudget budget_of(engine::Engine& engine, const model::ModelInput& input, const std::vector<Quantity>& quantities) {
  ErrorBudget out;
  const double start = cpu_time();
  const std::string none = why_none(input.scene);
  Snapshot state;
  engine.report(state);
  const std::vector<double> points = engine.points();
  std::optional<Blind> blind;
  if (none.empty() && !quantities.empty()) blind.emplace(input);
  if (blind && blind->soft()) blind->see(state.cell.at("cauchy_stress"));
  const bool contact = !effects::of_role(input.scene.at("effects"), effects::Role::contact).empty();
  for (const Quantity& q : quantities) {
    QuantityBudget& budget = out.of.emplace_back();
    const Gradient gradient = none.empty() ? known_gradient(q, input, state, points) : Gradient{{}, none + kFollowed};
    budget.why_not = gradient.why_not, budget.scale = gradient.scale;
    if (!budget.why_not.empty()) continue;
    solver::Adjoint adjoint;
    if (const engine::Outcome outcome = engine.adjoint(gradient.of, adjoint); outcome.code != 0) {
      budget.why_not = outcome.message;
      continue;
    }
    out.exact = out.exact && adjoint.exact;
    budget.parts.push_back(blind->part(adjoint.mesh));
    budget.parts.back().hidden = hidden_in(adjoint);
    if (contact) budget.parts.push_back({kGapPart, adjoint.layer, ""});
    budget.parts.push_back({kSolutionPart, adjoint.residual, ""});
    if (contact) budget.parts.push_back({kFacetsPart, NAN, "no estimate"});
  }
  out.seconds = cpu_time() - start;
  return out;
}

run::Estimated budget_of_run(engine::Engine* engine, const model::ModelInput& input, const std::string& fields) {
  run::Estimated out;
  const std::vector<Quantity> quantities = quantities_of(input.scene);
  ErrorBudget budget;
  if (engine)
    budget = budget_of(*engine, input, quantities);
  else
    for (std::size_t k = 0; k < quantities.size(); ++k) budget.of.emplace_back().why_not = "the run was continued after its last step";
  const output::FieldReader reader(fields);
  const std::string none = why_none(input.scene);
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    QuantityBudget& of = budget.of[k];
    if (engine && none.empty() && !of.why_not.empty() && group_of(quantities[k].value) != "steps")
      of.why_not += "; mortise study SCENE --error-budget has it";
    try {
      of.judge(measure(reader, quantities[k]));
      if (const double between = none.empty() ? turned_between(reader, quantities[k]) : 0; between > tuning::kPeakShare * std::abs(of.value)) {
        of.parts.push_back({kBetweenPart, NAN, what_lies_between(between / of.value)});
        of.parts.back().found = between;
      }
    } catch (const Error& e) {
      of.why_not = e.what();
    }
    out.worst = std::fmax(out.worst, of.share());
    if (!std::isfinite(of.value)) out.warnings.push_back(fmt::format("warning: quantity '{}' has no value: {}", quantities[k].name, of.why_not));
  }
  if (!none.empty() && !quantities.empty()) out.warnings.push_back("warning: errors of quantities are not estimated: " + none + kFollowed);
  out.json = budget_entries(quantities, budget);
  return out;
}

ErrorBudget find_error_budget(const Study& study, const Place& place) {
  run::install_signal_handlers();
  if (study.scene.empty()) throw Error(Exit::usage, "--error-budget is for scenes, not for benchmarks");
  if (study.quantities.empty()) throw Error(Exit::usage, "no quantity to look at: give --qoi group/name");
  const scene::Scene scene =
      scene::read_scene_text(variant_of(study, study.methods.front(), {}).yaml, study.scene, {"output.precision=double"}, engine::effect_tables());
  std::error_code ec;
  std::filesystem::create_directories(place.folder + "/runs", ec);
  if (const std::string none = why_none(scene.root); !none.empty()) return followed_budget(scene, study.quantities, place);

  Course course(scene, place.folder + "/runs/error_budget.vtkhdf", engine::choose(place.device, place.threads));
  check(course.engine().begin());
  const double seconds = take(course, {});
  ErrorBudget out = budget_of(course.engine(), course.input(), study.quantities);
  out.solve_seconds = seconds;
  const std::vector<double> values = course.measure(study.quantities);
  std::vector<std::size_t> unknown;
  std::vector<Quantity> others;
  for (std::size_t k = 0; k < values.size(); ++k) {
    out.of[k].judge(values[k]);
    if (!out.of[k].why_not.empty()) unknown.push_back(k), others.push_back(study.quantities[k]);
  }
  if (others.empty()) return out;
  // The same steps once more, with company.
  try {
    const ErrorBudget followed = followed_budget(scene, others, place);
    for (std::size_t i = 0; i < others.size(); ++i) out.of[unknown[i]] = followed.of[i];
    out.solve_seconds += followed.solve_seconds, out.note = followed.note;
  } catch (const Error& e) {
    if (e.code() != Exit::solve) throw;
    for (std::size_t k : unknown) out.of[k].why_not += std::string("; ") + e.what();
  }
  return out;
}

}  // namespace mortise::study
