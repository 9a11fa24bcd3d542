// Random scenes from a seed under the common checks of the hard cases, and their reduction when one fails.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "study/bench/hard.h"

namespace fs = std::filesystem;

namespace mortise::study {
namespace {

// The distributions of <random> differ between libraries; a seed must give the same scene everywhere.
class Dice {
 public:
  explicit Dice(unsigned long seed) : bits_(seed * 0x9e3779b97f4a7c15ull + 1) {}
  double in(double lo, double hi) { return lo + (hi - lo) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double power(double lo, double hi) { return std::pow(10.0, in(lo, hi)); }
  bool chance(double p) { return in(0, 1) < p; }
  int below(int n) { return static_cast<int>(in(0, n)); }

 private:
  std::mt19937_64 bits_;
};

std::string num(double v) { return fmt::format("{:.6g}", v); }
YAML::Node vec(double x, double y, double z) { return YAML::Load(fmt::format("[{}, {}, {}]", num(x), num(y), num(z))); }

// Scales of the scene: lengths L, times sqrt(L/g), speeds sqrt(g L).
struct Scales {
  double L, g = 9.81;
  double time() const { return std::sqrt(L / g); }
  double speed() const { return std::sqrt(g * L); }
};

// A shape and the radius of a ball around it.
YAML::Node shape(Dice& d, const Scales& s, double& radius) {
  const double a = s.L * d.in(0.3, 1), b = s.L * d.in(0.3, 1), c = s.L * d.in(0.3, 1);
  YAML::Node out;
  switch (d.below(4)) {
    case 0:
      radius = 0.5 * std::sqrt(a * a + b * b + c * c);
      out["box"]["size"] = vec(a, b, c);
      out["box"]["edge_length"] = num(std::max({a, b, c}) * d.in(0.3, 1));
      break;
    case 1:
      radius = 0.5 * a;
      out["sphere"]["radius"] = num(0.5 * a);
      out["sphere"]["edge_length"] = num(a * d.in(0.3, 0.5));
      break;
    case 2:
      radius = 0.5 * std::hypot(a, b);
      out["cylinder"]["radius"] = num(0.5 * a), out["cylinder"]["height"] = num(b);
      out["cylinder"]["edge_length"] = num(a * d.in(0.3, 0.6));
      break;
    default:
      radius = 0.5 * (a + b);
      out["capsule"]["radius"] = num(0.5 * a), out["capsule"]["height"] = num(b);
      out["capsule"]["edge_length"] = num(a * d.in(0.3, 0.5));
  }
  return out;
}

YAML::Node pin(Dice& d, const Scales& s, const std::string& body, double end) {
  YAML::Node p;
  p["body"] = body;
  p["where"]["side"] = "z_max";
  if (d.chance(0.6)) {
    p["motion"]["time"] = YAML::Load(fmt::format("[0, {}]", num(end)));
    YAML::Node way;
    way.push_back(vec(0, 0, 0)), way.push_back(vec(s.L * d.in(-0.3, 0.3), s.L * d.in(-0.3, 0.3), s.L * d.in(-0.3, 0.1)));
    p["motion"]["translation"] = way;
  }
  return p;
}

YAML::Node contact(Dice& d, const Scales& s, double modulus, const std::vector<std::string>& names, const std::vector<bool>& soft, bool half_space, bool mortar) {
  YAML::Node c;
  const double d_hat = s.L * d.power(-3.5, -2), stiffness = modulus * d.power(-1.5, 0);
  c["d_hat"] = num(d_hat);
  c["stiffness"] = num(stiffness);
  if (!mortar) {
    const bool classic = !d.chance(0.85);
    c["form"] = classic ? "classic" : "area_weighted";
    // Pairs of the classic form have the weight d_hat^2, a thousandth or a millionth of the triangles that they stand for.
    const double h = 0.3 * s.L;
    if (classic) c["stiffness"] = num(stiffness * h * h / (4 * d_hat * d_hat));
    return c;
  }
  // The last name is the floor. A half-space is never a slave; between bodies either side may be.
  for (std::size_t a = 0; a < names.size(); ++a)
    for (std::size_t b = a + 1; b < names.size(); ++b) {
      const bool swap = (b + 1 < names.size() || !half_space) && d.chance(0.3) && (b + 1 < names.size() ? soft[b] : true);
      YAML::Node pair;
      pair["slave"] = names[swap ? b : a], pair["master"] = names[swap ? a : b];
      c["pairs"].push_back(pair);
    }
  if (d.chance(0.2)) c["gradient"] = "exact";
  if (d.chance(0.1)) c["weights"] = "tapered";
  return c;
}

void checks(YAML::Node scene, bool soft, bool backward_euler, bool friction) {
  const auto add = [&](const char* quantity, const char* bound, const char* value) {
    YAML::Node c;
    c["quantity"] = quantity, c[bound] = value;
    scene["checks"].push_back(c);
  };
  add("min_distance", "above", "0");
  if (soft) add("min_det_f", "above", "1e-6");
  add("newton_iterations", "below", "2000");
  // With friction a step is solved to lag_tolerance only, and so is its energy.
  if (backward_euler) add("energy_gain", "below", friction ? "1e-2" : "1e-5");
}

YAML::Node random_scene(unsigned long seed) {
  Dice d(seed);
  Scales s{d.power(-3, 2)};
  const bool mortar = d.chance(0.4), half_space = d.chance(0.6), far = d.chance(0.1), backward_euler = d.chance(0.8);
  const double far_x = far ? 1e3 * s.L * d.in(-1, 1) : 0;
  const int bodies = 1 + d.below(4), steps = 8 + d.below(13);
  const double step = s.time() * d.power(-2.3, -0.5), density = d.power(2.3, 3.9);
  // Soft enough to deform, stiff enough not to be crushed by its own weight.
  const double modulus = density * s.g * s.L * d.power(0.8, 4);
  YAML::Node scene;
  scene["mortise"] = 1;
  scene["name"] = fmt::format("seed_{}", seed);
  scene["time"]["step"] = num(step), scene["time"]["steps"] = steps;
  static const char* const kModels[] = {"neo_hookean", "neo_hookean", "corotated", "linear"};
  double softest = modulus;
  for (int m = 0; m < 2; ++m) {
    YAML::Node material = scene["materials"][fmt::format("m{}", m)];
    const double E = modulus * (m ? d.power(-1, 2) : 1);
    softest = std::min(softest, E);
    material["model"] = kModels[d.below(4)];
    material["youngs_modulus"] = num(E), material["poisson_ratio"] = num(d.in(0, 0.48)), material["density"] = num(density * (m ? d.power(-1, 1) : 1));
  }
  std::vector<std::string> names;
  std::vector<bool> soft;
  double z = 0;
  for (int i = 0; i < bodies; ++i) {
    YAML::Node b;
    double radius = 0;
    soft.push_back(d.chance(0.75));
    b["type"] = soft[i] ? "soft" : "stiff";
    b["shape"] = shape(d, s, radius);
    b["material"] = fmt::format("m{}", d.below(2));
    z += 1.02 * radius + 0.01 * s.L;
    b["position"] = vec(far_x + s.L * d.in(-0.2, 0.2), s.L * d.in(-0.2, 0.2), z);
    z += 1.02 * radius;
    if (d.chance(0.7)) b["rotation"]["axis"] = vec(d.in(-1, 1), d.in(-1, 1), d.in(0.1, 1)), b["rotation"]["angle"] = num(d.in(-3, 3));
    b["velocity"] = vec(s.speed() * d.in(-0.5, 0.5), s.speed() * d.in(-0.5, 0.5), s.speed() * d.in(-3, 0));
    if (d.chance(0.3)) b["angular_velocity"] = vec(d.in(-2, 2) / s.time(), d.in(-2, 2) / s.time(), d.in(-2, 2) / s.time());
    if (soft[i] && !mortar && d.chance(0.2)) b["self_contact"] = true;
    names.push_back(fmt::format("body{}", i));
    scene["bodies"][names.back()] = b;
  }
  YAML::Node effects = scene["effects"];
  effects["inertia"]["integrator"] = backward_euler ? "backward_euler" : "bdf2";
  effects["gravity"]["acceleration"] = vec(0, 0, -s.g);
  const bool any_soft = std::find(soft.begin(), soft.end(), true) != soft.end();
  if (any_soft) effects["elasticity"] = YAML::Node(YAML::NodeType::Map);
  if (std::find(soft.begin(), soft.end(), false) != soft.end()) effects["affine_body"]["stiffness"] = num(100 * modulus);
  names.push_back("floor");
  if (half_space) {
    scene["bodies"]["floor"] = YAML::Load("{type: half_space}");
  } else {
    scene["bodies"]["floor"] = YAML::Load(fmt::format("{{type: stiff, material: m0, shape: {{box: {{size: [{0}, {0}, {1}], edge_length: {2}}}}}, position: [{3}, 0, {4}]}}", num(6 * s.L), num(0.4 * s.L),
                                                      num(6 * s.L / (1 + d.below(3))), num(far_x), num(-0.2 * s.L)));
    YAML::Node hold;
    hold["body"] = "floor", hold["where"]["side"] = "all";
    effects["pin"].push_back(hold);
  }
  if (soft[0] && d.chance(0.25)) effects["pin"].push_back(pin(d, s, names[0], step * steps));
  const std::string kind = mortar ? "mortar_contact" : "barrier_contact";
  effects[kind] = contact(d, s, softest, names, soft, half_space, mortar);
  const bool friction = d.chance(0.5);
  if (friction) effects["friction"]["follows"] = kind, effects["friction"]["mu"] = num(d.in(0.05, 1)), effects["friction"]["creep_speed"] = num(1e-3 * s.speed());
  scene["solver"]["force_tolerance"] = 0;
  if (d.chance(0.15)) scene["solver"]["linear"] = "cg";
  scene["output"]["precision"] = "double";
  checks(scene, any_soft, backward_euler, friction);
  return scene;
}

std::string emit(const YAML::Node& node) {
  YAML::Emitter out;
  out << node;
  return std::string(out.c_str()) + "\n";
}

// Two failures are of one kind when their reasons begin alike.
std::string kind_of(const HardRow& row) {
  const std::size_t end = row.reason.find_first_of("0123456789(");
  return row.reason.substr(0, std::min(end, row.reason.find(" of ")));
}

void forget_body(YAML::Node scene, const std::string& name) {
  scene["bodies"].remove(name);
  const auto keep = [&](YAML::Node list, const char* key) {
    YAML::Node out(YAML::NodeType::Sequence);
    for (const auto& item : list)
      if (item[key].as<std::string>() != name && !(item["master"] && item["master"].as<std::string>() == name)) out.push_back(item);
    return out;
  };
  YAML::Node effects = scene["effects"];
  if (effects["pin"]) effects["pin"] = keep(effects["pin"], "body");
  if (effects["pin"] && effects["pin"].size() == 0) effects.remove("pin");
  if (effects["mortar_contact"]) effects["mortar_contact"]["pairs"] = keep(effects["mortar_contact"]["pairs"], "slave");
}

// Smaller scenes to try, each a little less than the one given.
std::vector<YAML::Node> smaller(const YAML::Node& scene) {
  std::vector<YAML::Node> out;
  const auto with = [&](const std::function<void(YAML::Node)>& change) {
    YAML::Node copy = YAML::Clone(scene);
    change(copy);
    out.push_back(copy);
  };
  for (const auto& body : scene["bodies"]) {
    const std::string name = body.first.as<std::string>();
    if (scene["bodies"].size() > 1) with([&](YAML::Node s) { forget_body(s, name); });
    for (const char* key : {"rotation", "velocity", "angular_velocity", "self_contact"})
      if (body.second[key]) with([&](YAML::Node s) { s["bodies"][name].remove(key); });
  }
  for (const char* effect : {"friction", "pin", "gravity"})
    if (scene["effects"][effect]) with([&](YAML::Node s) { s["effects"].remove(effect); });
  const long steps = scene["time"]["steps"].as<long>();
  if (steps > 1) with([&](YAML::Node s) { s["time"]["steps"] = (steps + 1) / 2; }), with([&](YAML::Node s) { s["time"]["steps"] = steps - 1; });
  return out;
}

}  // namespace

HardCase fuzz_case(unsigned long seed) { return {fmt::format("seed_{}", seed), "", "", emit(random_scene(seed)), false}; }

std::string reduce(const HardCase& failed, const HardRow& row, const HardOptions& options) {
  YAML::Node scene = YAML::Load(failed.text);
  const std::string kind = kind_of(row);
  HardCase trial = failed;
  trial.variant = "smaller";
  double left = std::clamp(20 * row.seconds, 5.0, 30.0);  // seconds to spend
  for (bool found = true; found && left > 0;) {
    found = false;
    for (const YAML::Node& candidate : smaller(scene)) {
      if (left <= 0) break;
      trial.text = emit(candidate);
      const HardRow r = run_hard_case(trial, options);
      left -= r.seconds;
      if (r.pass || kind_of(r) != kind) continue;
      scene = candidate, found = true;
      break;
    }
  }
  const std::string path = fs::absolute(options.output).string() + "/" + failed.name + ".smallest.yaml";
  std::ofstream(path) << "# " << row.reason << "\n" << emit(scene);
  return path;
}

std::vector<HardRow> run_fuzz(const HardOptions& options, unsigned long first, unsigned long count, const std::function<void(const HardRow&)>& emit_row) {
  HardOptions o = options;
  fs::create_directories(o.output);
  o.output = fs::absolute(o.output).string();
  std::vector<HardRow> rows;
  for (unsigned long seed = first; seed < first + count; ++seed) {
    const HardCase c = fuzz_case(seed);
    HardRow row = run_hard_case(c, o);
    if (row.pass)
      fs::remove_all(o.output + "/" + c.name);
    else if (o.reduce)
      row.replay = fmt::format("mortise run {} --overwrite --no-render", reduce(c, row, o));
    rows.push_back(row);
    if (emit_row) emit_row(row);
  }
  return rows;
}

}  // namespace mortise::study
