#include "bench/harness.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "base/cpu_time.h"
#include "base/error.h"
#include "base/json_text.h"
#include "base/path_parts.h"
#include "engine/choose.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "geometry/topology.h"
#include "output/json_number.h"
#include "sensors/sensors.h"

namespace mortise::bench {
namespace {

using output::number_or_null;

std::string cell(double v) { return std::isnan(v) ? "-" : fmt::format("{:.6g}", v); }

YAML::Node child(const YAML::Node& node, const std::string& part) {
  if (!node.IsSequence()) return node[part];
  return node[std::stoul(part)];
}

void put(YAML::Node node, const std::vector<std::string>& parts, std::size_t at, const YAML::Node& value) {
  if (at + 1 < parts.size()) {
    put(child(node, parts[at]), parts, at + 1, value);
  } else if (node.IsSequence()) {
    node[std::stoul(parts[at])] = value;
  } else {
    node[parts[at]] = value;
  }
}

std::string emit(const YAML::Node& node) {
  YAML::Emitter out;
  out << node;
  return std::string(out.c_str()) + "\n";
}

void check(const engine::Outcome& o) {
  if (o.code != 0) throw Error(static_cast<Exit>(o.code), o.message);
}

}  // namespace

std::string json_line(const Row& r) {
  nlohmann::ordered_json j;
  j["case"] = r.name, j["method"] = r.method, j["quantity"] = r.quantity;
  j["value"] = number_or_null(r.value), j["reference"] = number_or_null(r.reference), j["error"] = number_or_null(r.error),
  j["gate"] = number_or_null(r.gate);
  if (r.gated() || r.failed)
    j["pass"] = r.pass();
  else
    j["pass"] = nullptr;
  if (const audit::Grade& as = r.as; !as.all.letter.empty())
    j["grade"] = as.all.letter, j["grade_reason"] = as.all.reason, j["grade_forces"] = as.forces.letter, j["graded"] = as.graded;
  j["seconds"] = number_or_null(r.seconds), j["cpu_seconds"] = number_or_null(r.cpu_seconds), j["newton_iterations"] = r.newton_iterations;
  j["dofs"] = r.dofs;
  return json_text(j);
}

std::string table_header() {
  return fmt::format("{:38} {:18} {:24} {:>12} {:>12} {:>11} {:>8} {:>5} {:>8} {:>7} {:>8}\n", "case", "method", "quantity", "value", "reference",
                     "error", "gate", "pass", "seconds", "newton", "dofs");
}

std::string table_line(const Row& r) {
  return fmt::format("{:38} {:18} {:24} {:>12} {:>12} {:>11} {:>8} {:>5} {:>8.3g} {:>7} {:>8}\n", r.name, r.method, r.quantity, cell(r.value),
                     cell(r.reference), cell(r.error), cell(r.gate), r.failed ? "fails" : (r.gated() ? (r.pass() ? "yes" : "NO") : "-"), r.seconds,
                     r.newton_iterations, r.dofs);
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all{{"gmcp_consistent", "mortar_contact", "consistent", true},
                                       {"gmcp_tapered", "mortar_contact", "tapered", false},
                                       {"ipc_area_weighted", "barrier_contact", "area_weighted", false},
                                       {"ipc_classic", "barrier_contact", "classic", false}};
  return all;
}

void SceneText::set(const std::string& path, const std::string& value) {
  YAML::Node root = YAML::Load(yaml_);
  try {
    put(root, path_parts(path), 0, YAML::Load(value));
  } catch (const std::exception&) {  // a key under a plain value, a place that is no number
    throw Error(Exit::usage, "--set " + path + ": the benchmark's scene has no such place");
  }
  yaml_ = emit(root);
}

void SceneText::set(const std::string& path, double value) { set(path, fmt::format("{:.17g}", value)); }

void SceneText::add(const std::string& list, const std::string& value) {
  YAML::Node root = YAML::Load(yaml_), node = root;
  for (const std::string& part : path_parts(list)) node.reset(child(node, part));
  node.push_back(YAML::Load(value));
  yaml_ = emit(root);
}

std::string SceneText::get(const std::string& path) const {
  YAML::Node node = YAML::Load(yaml_);
  for (const std::string& part : path_parts(path)) node.reset(child(node, part));
  return node.as<std::string>();
}

double SceneText::number(const std::string& path) const { return std::stod(get(path)); }

namespace {

std::string pin_where(const std::string& yaml, const std::function<bool(const YAML::Node&)>& is) {
  const YAML::Node pins = YAML::Load(yaml)["effects"]["pin"];
  for (std::size_t i = 0; i < pins.size(); ++i)
    if (is(pins[i])) return fmt::format("effects.pin.{}", i);
  throw Error(Exit::internal, "the benchmark's scene has no such pin");
}

}  // namespace

std::string SceneText::moving_pin() const {
  return pin_where(yaml_, [](const YAML::Node& pin) { return pin["motion"].IsDefined(); });
}

std::string SceneText::pin(const std::string& body, const std::string& axes) const {
  return pin_where(yaml_, [&](const YAML::Node& pin) { return pin["body"].as<std::string>() == body && pin["axes"].as<std::string>() == axes; });
}

void SceneText::use(const Method& method, double node_area) {
  YAML::Node root = YAML::Load(yaml_);
  YAML::Node effects = root["effects"];
  if (method.effect == "mortar_contact") {
    effects["mortar_contact"]["weights"] = method.weights;
  } else {
    const YAML::Node mortar = effects["mortar_contact"];
    YAML::Node barrier;
    barrier["d_hat"] = mortar["d_hat"];
    barrier["stiffness"] = mortar["stiffness"];
    barrier["form"] = method.weights;
    double d_hat, kappa;
    const bool given = YAML::convert<double>::decode(mortar["d_hat"], d_hat) && YAML::convert<double>::decode(mortar["stiffness"], kappa);
    if (method.weights == "classic" && given) {  // what is `auto` is so for every method
      barrier["stiffness"] = fmt::format("{:.17g}", kappa * node_area / (d_hat * d_hat));
    }
    effects.remove("mortar_contact");
    effects["barrier_contact"] = barrier;
  }
  yaml_ = emit(root);
}

Row Solved::row(const std::string& name, const Method& method, const std::string& quantity, double value, double reference, double error,
                double gate) const {
  return {name,       method.name, quantity,   converged ? value : NAN, reference, converged ? error : NAN, gate, seconds, newton, dofs,
          !converged, as,          cpu_seconds};
}

Solved solve(const SceneText& text, const std::function<void(model::ModelInput&)>& prepare, const std::function<void(const Snapshot&)>& each) {
  return solve(scene::read_scene_text(text.text(), "benchmark.yaml", {}, engine::effect_tables()), prepare, each);
}

Solved solve(const scene::Scene& scene, const std::function<void(model::ModelInput&)>& prepare, const std::function<void(const Snapshot&)>& each) {
  Solved out;
  out.input = engine::make_input(scene.root);
  if (prepare) prepare(out.input);
  for (const model::BodyInput& b : out.input.bodies) {
    if (b.type == model::BodyType::soft) out.dofs += 3 * static_cast<long>(b.nodes.size());
    if (b.type == model::BodyType::stiff) out.dofs += 12;
  }
  std::unique_ptr<engine::Engine> engine;
  check(engine::chosen().api->create(out.input, engine));
  sensors::Sensors sensors(out.input);
  audit::Certificate certificate(out.input);
  audit::EnergyAudit energy(out.input);
  const auto see = [&] {
    out.points = engine->points();
    out.fields = {};
    engine->report(out.fields);
    sensors.read(out.fields, out.points);
    certificate.state(out.fields);
    energy.state({out.fields, out.points});
  };
  see();
  const long steps = scene.root.at("time").integer("steps");
  out.converged = true;
  for (long i = 0; i < steps && out.converged; ++i) {
    solver::StepReport report;
    const auto begin = std::chrono::steady_clock::now();
    const double cpu = cpu_time();
    const engine::Outcome outcome = engine->step([] { return false; }, report);
    out.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out.cpu_seconds += cpu_time() - cpu;
    out.newton += report.newton;
    if (outcome.code == static_cast<int>(Exit::solve)) {
      out.converged = false, out.why = outcome.message;
      break;
    }
    check(outcome);
    out.steps.push_back(report);
    see();
    certificate.step(report);
    if (each) each(out.fields);
  }
  out.as = certificate.grade({"", "", "", out.converged ? Exit::done : Exit::solve, "", energy.result()});
  double contact = 0, total = 0;
  for (const auto& [key, value] : engine->clock().seconds) {
    total += value.first;
    if (key.first.ends_with("_contact") && key.second != "report") contact += value.first;
  }
  if (total > 0) out.contact_share = contact / total;
  return out;
}

void set_mesh(model::ModelInput& input, const std::string& body, const geometry::TetMesh& mesh) {
  for (model::BodyInput& b : input.bodies) {
    if (b.name != body) continue;
    model::set_mesh(b, mesh);
    b.params.remove("shape");  // it stood for this mesh, and says nothing of it
    if (b.type == model::BodyType::stiff) {
      const geometry::TriMesh surface = geometry::surface_of(mesh);
      b.nodes = surface.points, b.triangles = surface.triangles;
      b.tets.clear();
    }
    return;
  }
  throw Error(Exit::internal, "no body '" + body + "' to give a mesh to");
}

}  // namespace mortise::bench
