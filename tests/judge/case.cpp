#include "judge/case.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>

namespace judge {
namespace {

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> out;
  std::string line;
  for (char c : text + "\n") {
    if (c != '\n') {
      line += c;
      continue;
    }
    if (!line.empty()) out.push_back(line);
    line.clear();
  }
  return out;
}

Vector vector_of(const YAML::Node& n) { return {n[0].as<double>(), n[1].as<double>(), n[2].as<double>()}; }

// Faces of tetrahedra that belong to one of them only, in the tetrahedron's order (outward); of quadratic ones their quarters.
std::vector<std::array<long, 3>> boundary(const Body& body) {
  constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  constexpr int kMiddle[4][4] = {{-1, 0, 2, 3}, {0, -1, 1, 4}, {2, 1, -1, 5}, {3, 4, 5, -1}};  // of the edge between two corners
  std::map<std::array<long, 3>, std::pair<int, std::vector<std::array<long, 3>>>> seen;
  for (std::size_t e = 0; e < body.tets.size(); ++e)
    for (const auto& f : kFaces) {
      const auto& t = body.tets[e];
      const std::array<long, 3> face{t[f[0]], t[f[1]], t[f[2]]};
      auto key = face;
      std::sort(key.begin(), key.end());
      auto& entry = seen[key];
      if (++entry.first > 1) continue;
      entry.second = {face};
      if (!body.quadratic()) continue;
      long m[3];
      for (int k = 0; k < 3; ++k) m[k] = body.midsides[e][kMiddle[f[k]][f[(k + 1) % 3]]];
      entry.second = {{face[0], m[0], m[2]}, {face[1], m[1], m[0]}, {face[2], m[2], m[1]}, {m[0], m[1], m[2]}};
    }
  std::vector<std::array<long, 3>> out;
  for (const auto& [key, entry] : seen)
    if (entry.first == 1) out.insert(out.end(), entry.second.begin(), entry.second.end());
  return out;
}

}  // namespace

void read_mesh(const File& file, Case& c) {
  const auto connectivity = file.numbers("/VTKHDF/Connectivity"), offsets = file.numbers("/VTKHDF/Offsets"), types = file.numbers("/VTKHDF/Types");
  const auto cell_body = file.numbers("/VTKHDF/CellData/body_id"), point_body = file.numbers("/VTKHDF/PointData/body_id"),
             rest = file.numbers("/mortise/mesh/rest_points");
  for (const std::string& name : lines(file.text("/mortise/mesh/body_names"))) {
    c.bodies.emplace_back();
    c.bodies.back().name = name;
  }
  for (std::size_t i = 0; i < rest.size() / 3; ++i) {
    c.rest.push_back({rest[3 * i], rest[3 * i + 1], rest[3 * i + 2]});
    c.bodies.at(point_body[i]).points.push_back(i);
  }
  for (std::size_t k = 0; k < types.size(); ++k) {
    Body& body = c.bodies.at(cell_body[k]);
    const auto id = [&](int i) { return static_cast<long>(connectivity[offsets[k] + i]); };
    if (types[k] == 5) body.triangles.push_back({id(0), id(1), id(2)});
    if (types[k] == 10 || types[k] == 24) body.tets.push_back({id(0), id(1), id(2), id(3)});
    if (types[k] == 24) body.midsides.push_back({id(4), id(5), id(6), id(7), id(8), id(9)});
  }
  for (Body& body : c.bodies) {
    body.soft = !body.tets.empty();
    if (body.soft) body.triangles = boundary(body);
  }
}

namespace {

Vector unit(const Vector& v) { return (1 / norm(v)) * v; }

std::string text(const YAML::Node& of, const char* key) { return of[key] ? of[key].as<std::string>() : ""; }
std::string name_of(const YAML::Node& tie) {
  const std::string to = text(tie, "to");
  return tie["name"] ? text(tie, "name") : text(tie, "body") + "_" + (to.empty() ? "world" : to);
}

// A slide whose way is that of another beside it, r times: p_c = r p_a + (1 - r) p_t + ..., so that a force on c is r of it at a and 1 - r at t. What
// follows in another manner is pulled by a force of its own, of which r times is missing on its leader.
void slide(const YAML::Node& effects, const YAML::Node& joint, const std::string& name, Tie& tie, Case& c) {
  Slide s{name, tie.share[0].first, tie.share[1].first, unit(vector_of(joint["axis"])), false, {}};
  if (const YAML::Node mimic = joint["mimic"]) {
    const std::string leader = mimic["joint"].as<std::string>();
    for (const YAML::Node& other : effects["joint"])
      if (name_of(other) == leader && text(other, "type") == "prismatic" && text(other, "to") == text(joint, "to") &&
          std::abs(dot(s.axis, unit(vector_of(other["axis"])))) > 1 - 1e-9) {
        const double r = (mimic["ratio"] ? mimic["ratio"].as<double>() : 1) * dot(s.axis, unit(vector_of(other["axis"])));
        tie.share[1].second = -(1 - r);
        tie.share.emplace_back(other["body"].as<std::string>(), -r);
      }
  }
  for (const YAML::Node& drive : effects["drive"])
    if (drive["joint"].as<std::string>() == name) s.given = drive["mode"].as<std::string>() == "kinematic";
  for (const YAML::Node& other : effects["joint"])
    if (const YAML::Node mimic = other["mimic"]; mimic && text(mimic, "joint") == name)
      s.leads.emplace_back("/mortise/effects/joint/" + name_of(other) + "_coupling", -(mimic["ratio"] ? mimic["ratio"].as<double>() : 1));
  c.slides.push_back(s);
}

}  // namespace

// Does `where` catch three points of the body that are not on a line?
bool catches_a_face(const YAML::Node& where, const Body& body, const std::vector<Vector>& rest) {
  Vector lo{INFINITY, INFINITY, INFINITY}, hi{-INFINITY, -INFINITY, -INFINITY};
  for (long p : body.points)
    for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], rest[p][k]), hi[k] = std::max(hi[k], rest[p][k]);
  const double size = norm(hi - lo);
  const auto inside = [&](const Vector& x) {
    if (where["side"]) {
      const std::string side = where["side"].as<std::string>();
      if (side == "all") return true;
      const int k = side[0] - 'x';
      return side.substr(2) == "min" ? x[k] <= lo[k] + 1e-6 * size : x[k] >= hi[k] - 1e-6 * size;
    }
    if (where["sphere"]) return norm(x - vector_of(where["sphere"]["centre"])) <= where["sphere"]["radius"].as<double>();
    const Vector a = vector_of(where["box"]["min"]), b = vector_of(where["box"]["max"]);
    for (int k = 0; k < 3; ++k)
      if (x[k] < a[k] || x[k] > b[k]) return false;
    return true;
  };
  std::vector<Vector> caught;
  for (long p : body.points)
    if (inside(rest[p])) caught.push_back(rest[p]);
  double most = 0;
  for (const Vector& x : caught)
    for (const Vector& y : caught) most = std::max(most, norm(cross(x - caught[0], y - caught[0])));
  return most > 1e-6 * size * size;
}

void read_scene(const File& file, Case& c) {
  const YAML::Node scene = YAML::Load(file.text("/mortise/scene"));
  std::vector<std::string> names;
  for (const auto& entry : scene["bodies"]) {
    const std::string name = entry.first.as<std::string>();
    names.push_back(name);
    const YAML::Node b = entry.second;
    if (b["type"].as<std::string>() == "half_space") {
      c.planes.push_back({name, vector_of(b["point"]), vector_of(b["normal"])});
      continue;
    }
    for (Body& body : c.bodies)
      if (body.name == name) {
        const YAML::Node material = b["material"] ? scene["materials"][b["material"].as<std::string>()] : YAML::Node(YAML::NodeType::Map);
        if (material["density"]) body.density = material["density"].as<double>();
        if (b["mass"]) {
          double filled = 0;
          for (const auto& t : body.triangles) filled += volume({}, c.rest[t[0]], c.rest[t[1]], c.rest[t[2]]);
          body.density = b["mass"].as<double>() / filled;
        }
        if (b["inertia"]) body.spread = stated_spread(b, body, c.rest);
        if (material["youngs_modulus"])
          body.youngs_modulus = material["youngs_modulus"].as<double>(), body.poisson_ratio = material["poisson_ratio"].as<double>();
        const std::string volumetric = material["volumetric"] ? material["volumetric"].as<std::string>() : "auto";
        body.mean_volume = volumetric == "averaged" || (volumetric == "auto" && body.poisson_ratio > 0.4);
        if (material["model"]) body.law = material["model"].as<std::string>();
        body.self_contact = body.soft && (!b["self_contact"] || b["self_contact"].as<bool>());
      }
  }
  const YAML::Node effects = scene["effects"];
  if (effects["gravity"] && effects["gravity"]["acceleration"]) c.gravity = vector_of(effects["gravity"]["acceleration"]);
  c.double_precision = scene["output"] && scene["output"]["precision"] && scene["output"]["precision"].as<std::string>() == "double";
  c.contact = effects["barrier_contact"] || effects["mortar_contact"];
  c.inertia = static_cast<bool>(effects["inertia"]), c.friction = static_cast<bool>(effects["friction"]),
  c.loads = static_cast<bool>(effects["pressure_load"]);
  c.bdf2 = c.inertia && effects["inertia"]["integrator"] && effects["inertia"]["integrator"].as<std::string>() == "bdf2";
  if (scene["solver"] && scene["solver"]["relative_tolerance"]) c.tolerance = scene["solver"]["relative_tolerance"].as<double>();
  if (c.friction && effects["friction"]["lag_tolerance"]) c.tolerance = std::max(c.tolerance, effects["friction"]["lag_tolerance"].as<double>());
  if (const YAML::Node time = scene["time"]) {
    if (time["step"]) c.step = time["step"].as<double>();
    if (time["frame_every"]) c.frame_every = time["frame_every"].as<long>();
  }
  for (const auto& p : scene["pairs"])
    if (!p["collide"].as<bool>())
      for (const auto& a : p["bodies"])
        for (const auto& b : p["bodies"]) c.pass.insert({a.as<std::string>(), b.as<std::string>()});
  for (const char* effect : {"joint", "bond", "mortar_tie"})
    for (const auto& t : effects[effect]) {
      const std::string body = t["body"].as<std::string>(), to = t["to"] ? t["to"].as<std::string>() : "";
      const std::string name = name_of(t);
      Tie& tie = c.ties.emplace_back(Tie{std::string("/mortise/effects/") + effect + "/" + name + "_force_", {{body, 1}, {to, -1}}});
      if (std::string(effect) == "joint" && t["type"].as<std::string>() == "prismatic") slide(effects, t, name, tie, c);
      const std::string guide = std::string("/mortise/effects/") + effect + "/" + name + "_guide_";
      if (file.has(guide + "x")) c.ties.push_back(Tie{guide, {{body, 1}, {to, -1}}});
      if (!t["contact"] || !t["contact"].as<bool>()) c.pass.insert({body, to}), c.pass.insert({to, body});
    }
  const auto watch = [&](const std::string& a, const std::string& b) { c.watched.insert({a, b}), c.watched.insert({b, a}); };
  if (const YAML::Node barrier = effects["barrier_contact"]) {
    if (barrier["pairs"]) {
      for (const auto& p : barrier["pairs"]) watch(p[0].as<std::string>(), p[1].as<std::string>());
    } else {
      for (const std::string& a : names)
        for (const std::string& b : names) watch(a, b);
    }
  }
  if (const YAML::Node mortar = effects["mortar_contact"])
    for (const auto& p : mortar["pairs"]) watch(p["slave"].as<std::string>(), p["master"].as<std::string>());
  for (const auto& p : effects["pin"])
    for (Body& body : c.bodies) {
      if (body.name != p["body"].as<std::string>()) continue;
      body.pinned = true;
      const bool all = p["where"]["side"] && p["where"]["side"].as<std::string>() == "all",
                 every = !p["axes"] || p["axes"].as<std::string>().size() == 3;
      const bool turns = p["motion"] && (p["motion"]["rotation"] || p["motion"]["orientation"] || p["motion"]["file"]);
      body.stays = body.stays || (every && !turns && !p["release"] && catches_a_face(p["where"], body, c.rest));
      if (!all || !every || p["release"]) continue;
      body.prescribed = true;
      if (p["motion"]) body.motion = YAML::Dump(p["motion"]);
    }
}

bool Case::apart(const Body& a, const Body* b, const std::string& other) const {
  if (!contact || (b != &a && pass.count({a.name, other}))) return false;
  if (a.prescribed && (!b || b->prescribed)) return a.motion != (b ? b->motion : "");
  return b == &a ? a.self_contact : watched.count({a.name, other}) > 0;
}

}  // namespace judge
