// Random scenes from a seed under the common checks of the hard cases, and their reduction when one fails.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "bench/hard/dice.h"
#include "bench/hard/hard.h"

namespace fs = std::filesystem;

namespace mortise::bench::hard {
namespace {

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

YAML::Node contact(Dice& d, const Scales& s, double modulus, const std::vector<std::string>& names, const std::vector<bool>& soft, bool half_space,
                   bool mortar) {
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
    material["youngs_modulus"] = num(E), material["poisson_ratio"] = num(d.in(0, 0.48)),
    material["density"] = num(density * (m ? d.power(-1, 1) : 1));
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
    scene["bodies"]["floor"] =
        YAML::Load(fmt::format("{{type: stiff, material: m0, shape: {{box: {{size: [{0}, {0}, {1}], edge_length: {2}}}}}, position: [{3}, 0, {4}]}}",
                               num(6 * s.L), num(0.4 * s.L), num(6 * s.L / (1 + d.below(3))), num(far_x), num(-0.2 * s.L)));
    YAML::Node hold;
    hold["body"] = "floor", hold["where"]["side"] = "all";
    effects["pin"].push_back(hold);
  }
  if (soft[0] && d.chance(0.25)) effects["pin"].push_back(pin(d, s, names[0], step * steps));
  const std::string kind = mortar ? "mortar_contact" : "barrier_contact";
  effects[kind] = contact(d, s, softest, names, soft, half_space, mortar);
  const bool friction = d.chance(0.5);
  if (friction)
    effects["friction"]["follows"] = kind, effects["friction"]["mu"] = num(d.in(0.05, 1)), effects["friction"]["creep_speed"] = num(1e-3 * s.speed());
  scene["solver"]["force_tolerance"] = 0;
  if (d.chance(0.15)) scene["solver"]["linear"] = "cg";
  scene["output"]["precision"] = "double";
  checks(scene, any_soft, backward_euler, friction);
  return scene;
}

// All that a run of the case has left: folders, scene and meshes.
void remove_files(const std::string& folder, const std::string& name) {
  std::vector<fs::path> own;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    if (file.starts_with(name) && (file.size() == name.size() || !std::isdigit(static_cast<unsigned char>(file[name.size()]))))
      own.push_back(entry.path());
  }
  for (const fs::path& path : own) fs::remove_all(path);
}

}  // namespace

Case fuzz_case(unsigned long seed) { return {fmt::format("seed_{}", seed), "", "", emit(random_scene(seed)), false}; }

std::string cause(const Row& row) {
  if (row.pass) return "";
  const std::string& r = row.reason;
  const std::size_t failed = r.find(") failed: ");  // "exit code 5: step 3 (t = ...) failed: why"
  const std::string why = failed == std::string::npos ? r : "a step fails: " + r.substr(failed + 10);
  const std::size_t from = why.starts_with("exit code") ? 11 : 0;
  return why.substr(0, std::min({why.find_first_of("0123456789('", from), why.find(" of ", from), why.size()}));
}

std::string causes(const std::vector<Row>& rows) {
  std::map<std::string, std::vector<std::string>> by_cause;
  for (const Row& row : rows)
    if (!row.pass) by_cause[(row.unsafe.empty() ? "" : "UNSAFE ") + cause(row)].push_back(row.name.substr(row.name.find('_') + 1));
  std::vector<std::pair<std::string, std::vector<std::string>>> sorted(by_cause.begin(), by_cause.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  std::string out;
  for (const auto& [what, seeds] : sorted) {
    out += fmt::format("{:5} {}:", seeds.size(), what);
    for (const std::string& seed : seeds) out += " " + seed;
    out += "\n";
  }
  return out;
}

std::vector<Row> run_fuzz(const Options& options, unsigned long first, unsigned long count, const std::function<void(const Row&)>& emit_row) {
  Options o = options;
  fs::create_directories(o.output);
  o.output = fs::absolute(o.output).string();
  std::vector<Row> rows;
  for (unsigned long seed = first; seed < first + count; ++seed) {
    const Case c = o.wild ? wild_case(seed, o.output) : fuzz_case(seed);
    Row row = run_case(c, o);
    if (row.pass)
      remove_files(o.output, c.name);
    else if (o.reduce)
      row.replay = fmt::format("mortise run {} --overwrite --no-render", reduce(c, row, o));
    rows.push_back(row);
    if (emit_row) emit_row(row);
  }
  return rows;
}

}  // namespace mortise::bench::hard
