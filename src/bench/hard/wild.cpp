// Random scenes that are not tame: what users combine and tests of one thing at a time do not. Small, so that a thousand take an hour.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "bench/hard/dice.h"
#include "bench/hard/hard.h"
#include "geometry/io/msh.h"
#include "geometry/io/obj.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"

namespace fs = std::filesystem;

namespace mortise::bench::hard {
namespace {

class Wild {
 public:
  Wild(unsigned long seed, const std::string& folder) : d_(seed ^ 0x77696c64ul), seed_(seed), folder_(folder) {
    scene_["mortise"] = 1;
    scene_["name"] = fmt::format("wild_{}", seed);
    s_.L = d_.power(-3, 1);
    const double kind = d_.in(0, 1);
    is_static_ = kind<0.2, bdf2_ = kind> 0.75;
    const bool crowd = !is_static_ && d_.chance(0.1);
    bodies_ = is_static_ ? 2 + d_.below(2) : crowd ? 5 + d_.below(16) : 1 + d_.below(4);
    crowd_ = bodies_ > 4;
    steps_ = is_static_ ? 2 + d_.below(5) : crowd_ ? 5 + d_.below(4) : 5 + d_.below(8);
    step_ = s_.time() * d_.power(-2, -0.7);
  }

  Case make() {
    materials();
    for (int i = 0; i < bodies_; ++i) body(i);
    floor();
    supports();
    contact();
    loads();
    sensors();
    solver();
    checks();
    Case c{fmt::format("wild_{}", seed_), "", "", emit(scene_), false};
    c.may_stop = "supports prescribe the motion of both";  // the dice may drive one body into another
    if (d_.chance(0.1)) c.arguments = {"--device", "debug"};
    c.interrupted = d_.chance(0.15);
    return c;
  }

 private:
  double end() const { return is_static_ ? 1 : step_ * steps_; }

  void materials() {
    static const char* const kModels[] = {"neo_hookean", "neo_hookean", "corotated", "linear"};
    density_ = d_.power(2.5, 3.9);
    modulus_ = density_ * s_.g * s_.L * d_.power(1.2, 4);
    softest_ = modulus_;
    for (int m = 0; m < 2; ++m) {
      const double E = modulus_ * (m ? d_.power(-0.5, 2) : 1);
      softest_ = std::min(softest_, E);
      YAML::Node material = scene_["materials"][fmt::format("m{}", m)];
      material["model"] = kModels[d_.below(4)];
      material["youngs_modulus"] = num(E), material["poisson_ratio"] = num(d_.chance(0.2) ? d_.in(0.48, 0.499) : d_.in(0, 0.48));
      material["density"] = num(density_ * (m ? d_.power(-1, 1) : 1));
    }
  }

  // A ball or block with bumps, written as the file that users have: tetrahedra, or a surface that the program fills.
  YAML::Node mesh_file(int i, double a, bool soft) {
    geometry::TetMesh mesh = d_.chance(0.5) ? geometry::sphere(0.5 * a, 0.5 * a) : geometry::box({a, a, 0.7 * a}, {2, 2, 2});
    const Vec3 k(d_.in(1, 3) / a, d_.in(1, 3) / a, d_.in(1, 3) / a);
    for (Vec3& x : mesh.points) x *= 1 + 0.08 * std::sin(k.dot(x) + 1);
    const bool surface = !soft || d_.chance(0.3);
    const std::string path = folder_ + fmt::format("/wild_{}_{}.{}", seed_, i, surface ? "obj" : "msh");
    if (surface)
      geometry::write_obj(path, geometry::surface_of(mesh));
    else
      geometry::write_msh(path, mesh);
    YAML::Node out;
    out["mesh"]["file"] = path;
    if (surface && soft) out["mesh"]["edge_length"] = num(0.6 * a);
    return out;
  }

  // A shape and the radius of a ball around it.
  YAML::Node shape(int i, bool soft, bool& round, double& radius) {
    const double a = s_.L * d_.in(0.4, 1), b = s_.L * d_.in(0.4, 1), c = s_.L * d_.in(0.4, 1);
    const double fine = crowd_ ? 1 : d_.in(0.5, 1);
    YAML::Node out;
    round = false;
    if (!crowd_ && d_.chance(0.15)) {
      radius = a;
      return mesh_file(i, a, soft);
    }
    switch (crowd_ ? 0 : d_.below(4)) {
      case 0:
        radius = 0.5 * std::sqrt(a * a + b * b + c * c);
        out["box"]["size"] = vec(a, b, c);
        out["box"]["edge_length"] = num(std::max({a, b, c}) * fine);
        return out;
      case 1:
        radius = 0.5 * a;
        out["sphere"]["radius"] = num(0.5 * a), out["sphere"]["edge_length"] = num(0.5 * a * std::max(fine, 0.7));
        break;
      case 2:
        radius = 0.5 * std::hypot(a, b);
        out["cylinder"]["radius"] = num(0.5 * a), out["cylinder"]["height"] = num(b),
        out["cylinder"]["edge_length"] = num(0.5 * a * std::max(fine, 0.8));
        break;
      default:
        radius = 0.5 * (a + b);
        out["capsule"]["radius"] = num(0.5 * a), out["capsule"]["height"] = num(b), out["capsule"]["edge_length"] = num(0.5 * a);
    }
    round = true;
    return out;
  }

  void body(int i) {
    YAML::Node b;
    double radius = 0;
    bool round = false;
    const bool soft = is_static_ ? true : d_.chance(0.7);
    b["type"] = soft ? "soft" : "stiff";
    b["shape"] = shape(i, soft, round, radius);
    b["material"] = fmt::format("m{}", d_.below(2));
    if (soft && !crowd_ && !b["shape"]["mesh"] && d_.chance(0.35)) {
      b["order"] = 2;
      if (round && d_.chance(0.5)) b["curved"] = true;
    }
    const bool turned = !is_static_ && d_.chance(0.6);
    if (turned) b["rotation"]["axis"] = vec(d_.in(-1, 1), d_.in(-1, 1), d_.in(0.1, 1)), b["rotation"]["angle"] = num(d_.in(-3, 3));
    place(b, i, radius, turned);
    if (!is_static_) {
      b["velocity"] = vec(s_.speed() * d_.in(-0.5, 0.5), s_.speed() * d_.in(-0.5, 0.5), s_.speed() * d_.in(-3, 0));
      if (d_.chance(0.3)) b["angular_velocity"] = vec(d_.in(-2, 2) / s_.time(), d_.in(-2, 2) / s_.time(), d_.in(-2, 2) / s_.time());
    }
    if (soft && d_.chance(0.1)) b["self_contact"] = false;
    names_.push_back(fmt::format("body{}", i)), soft_.push_back(soft);
    scene_["bodies"][names_.back()] = b;
  }

  // One above the other; a crowd in layers of four. Boxes that are not turned sit by their own height, close to what is below.
  void place(YAML::Node b, int i, double radius, bool turned) {
    double half = radius;
    if (!turned && b["shape"]["box"]) half = 0.5 * b["shape"]["box"]["size"][2].as<double>();
    if (!turned && b["shape"]["sphere"]) half = b["shape"]["sphere"]["radius"].as<double>();
    if (!turned && b["shape"]["cylinder"]) half = 0.5 * b["shape"]["cylinder"]["height"].as<double>();
    const double gap = s_.L * (is_static_ ? 0.005 : 0.02);
    if (crowd_) {
      const double cell = 1.9 * s_.L;
      b["position"] = vec(cell * (i % 2), cell * (i / 2 % 2), s_.L * 0.95 + cell * (i / 4));
      return;
    }
    z_ += half + gap;
    b["position"] = vec(s_.L * d_.in(-0.15, 0.15), s_.L * d_.in(-0.15, 0.15), z_);
    z_ += half;
  }

  void floor() {
    half_space_ = d_.chance(0.6);
    names_.push_back("floor"), soft_.push_back(false);
    if (half_space_) {
      scene_["bodies"]["floor"] = YAML::Load("{type: half_space}");
      return;
    }
    const bool soft = d_.chance(0.2);  // held wholly: an obstacle like a stiff one
    scene_["bodies"]["floor"] = YAML::Load(fmt::format(
        "{{type: {0}, material: m0, shape: {{box: {{size: [{1}, {1}, {2}], edge_length: {3}}}}}, position: [{4}, {4}, {5}]}}",
        soft ? "soft" : "stiff", num(7 * s_.L), num(0.4 * s_.L), num(7 * s_.L / (1 + d_.below(3))), num(crowd_ ? s_.L : 0), num(-0.2 * s_.L)));
    YAML::Node hold;
    hold["body"] = "floor", hold["where"]["side"] = "all";
    scene_["effects"]["pin"].push_back(hold);
    soft_floor_ = soft;
  }

  YAML::Node motion(double down, bool turns) {
    YAML::Node m, way, time;
    const int keys = 2 + d_.below(2);
    for (int k = 0; k < keys; ++k) time.push_back(num(end() * k / (keys - 1)));
    way.push_back(vec(0, 0, 0));
    for (int k = 1; k < keys; ++k) way.push_back(vec(s_.L * d_.in(-0.2, 0.2), s_.L * d_.in(-0.2, 0.2), -s_.L * down * d_.in(0.3, 1)));
    m["time"] = time, m["translation"] = way;
    if (turns) {
      m["rotation"]["axis"] = vec(0, 0, 1);
      for (int k = 0; k < keys; ++k) m["rotation"]["angle"].push_back(num(k * d_.in(-0.5, 0.5)));
    }
    return m;
  }

  // Statics: every body is held by one side, so that there is an equilibrium; those above press on the lowest.
  void supports() {
    for (int i = 0; i < bodies_; ++i) {
      YAML::Node p;
      p["body"] = names_[i];
      const bool drives = !is_static_ && d_.chance(soft_[i] ? 0.15 : 0.25);
      if (is_static_) {
        p["where"]["side"] = i == 0 ? "z_min" : d_.chance(0.5) || i + 1 == bodies_ ? "z_max" : "x_min";
        if (i > 0 || !half_space_) p["motion"] = motion(i == 0 ? 0 : 0.06 * i, d_.chance(0.2));
      } else if (drives) {
        p["where"]["side"] = soft_[i] && d_.chance(0.7) ? "z_max" : "all";
        if (d_.chance(0.8)) p["motion"] = motion(0.2, d_.chance(0.4));
        if (d_.chance(0.2)) p["release"] = num(0.6 * end());
      } else {
        continue;
      }
      scene_["effects"]["pin"].push_back(p);
    }
  }

  void contact() {
    YAML::Node effects = scene_["effects"];
    const bool loose_stiff = std::count(soft_.begin(), soft_.end() - 1, false) > 0,
               any_soft = soft_floor_ || std::count(soft_.begin(), soft_.end(), true) > 0;
    if (!is_static_) effects["inertia"]["integrator"] = bdf2_ ? "bdf2" : "backward_euler";
    if (!is_static_ || d_.chance(0.5)) effects["gravity"]["acceleration"] = vec(0, 0, is_static_ ? -0.1 * s_.g : -s_.g);
    if (any_soft) effects["elasticity"] = YAML::Node(YAML::NodeType::Map);
    if (loose_stiff) effects["affine_body"]["stiffness"] = num(100 * modulus_);
    const double d_hat = s_.L * d_.power(-3, -1.8), stiffness = softest_ * d_.power(-1.5, 0);
    const bool mixed = names_.size() > 2 && d_.chance(0.1), mortar = mixed || d_.chance(0.4);
    YAML::Node b, m;
    b["d_hat"] = m["d_hat"] = num(d_hat), b["stiffness"] = num(stiffness);
    // Automatic only where there is something to choose it from: a body that deforms.
    const auto add_mortar = [&](std::size_t lo, std::size_t hi) {
      const bool swap = (hi + 1 < names_.size() || !half_space_) && d_.chance(0.3);
      YAML::Node pair;
      pair["slave"] = names_[swap ? hi : lo], pair["master"] = names_[swap ? lo : hi];
      m["pairs"].push_back(pair);
      automatic_ &= soft_[lo] || soft_[hi];
    };
    for (std::size_t lo = 0; lo < names_.size(); ++lo)
      for (std::size_t hi = lo + 1; hi < names_.size(); ++hi) {
        if (!mortar) continue;
        const bool last = lo + 2 == names_.size();
        if (mixed && !last && d_.chance(0.5)) {
          YAML::Node pair;
          pair.push_back(names_[lo]), pair.push_back(names_[hi]);
          b["pairs"].push_back(pair);
        } else {
          add_mortar(lo, hi);
        }
      }
    if (mortar) {
      if (!automatic_ || d_.chance(0.6)) m["stiffness"] = num(stiffness);
      if (d_.chance(0.2)) m["gradient"] = "exact";
      if (d_.chance(0.15)) m["quadrature"] = d_.chance(0.5) ? "7" : "6";
      effects["mortar_contact"] = m;
    }
    if (!mortar || b["pairs"]) effects["barrier_contact"] = b;
    friction_ = d_.chance(0.5);
    if (friction_) {
      effects["friction"]["follows"] = mortar ? "mortar_contact" : "barrier_contact", effects["friction"]["mu"] = num(d_.in(0.05, 1));
      effects["friction"]["creep_speed"] = num(1e-3 * s_.speed());
    }
  }

  void loads() {
    for (int i = 0; i < bodies_; ++i) {
      const YAML::Node b = scene_["bodies"][names_[i]];
      const bool flat = b["shape"]["box"].IsDefined() && !b["rotation"].IsDefined();  // has a side that z_max selects
      if (!soft_[i] || !flat || !d_.chance(is_static_ ? 0.3 : 0.1)) continue;
      YAML::Node load;
      load["body"] = names_[i], load["where"]["side"] = "z_max";
      const double p = softest_ * d_.in(-0.05, 0.1);
      if (d_.chance(0.5))
        load["pressure"] = num(p);
      else
        load["traction"] = vec(0.3 * p, 0, p);
      scene_["effects"]["pressure_load"].push_back(load);
      loaded_ = true;
    }
  }

  void sensors() {
    if (!d_.chance(0.2)) return;
    for (int i = 0; i < bodies_; ++i) {
      const YAML::Node b = scene_["bodies"][names_[i]];
      if (!b["shape"]["box"].IsDefined() || b["rotation"].IsDefined()) continue;
      const auto at = [&](const char* key, int k) { return b[key][k].as<double>(); };
      const auto size = [&](int k) { return b["shape"]["box"]["size"][k].as<double>(); };
      YAML::Node sensor = scene_["sensors"]["skin"];
      sensor["body"] = names_[i], sensor["normal"] = vec(0, 0, -1);
      sensor["position"] = vec(at("position", 0), at("position", 1), at("position", 2) - size(2) / 2);
      sensor["rows"] = 3 + d_.below(4), sensor["columns"] = 3 + d_.below(4);
      sensor["width"] = num(0.9 * size(0)), sensor["height"] = num(0.9 * size(1));
      return;
    }
  }

  void solver() {
    if (is_static_)
      scene_["time"]["mode"] = "static";
    else
      scene_["time"]["step"] = num(step_);
    scene_["time"]["steps"] = steps_;
    scene_["solver"]["force_tolerance"] = 0;
    const double linear = d_.in(0, 1);
    if (linear < 0.15) scene_["solver"]["linear"] = "cg";
    if (linear > 0.85) scene_["solver"]["linear"] = "reuse";
    scene_["output"]["precision"] = "double";
  }

  void checks() {
    const auto add = [&](const char* quantity, const char* bound, const char* value) {
      YAML::Node c;
      c["quantity"] = quantity, c[bound] = value;
      scene_["checks"].push_back(c);
    };
    add("min_distance", "above", "0");
    if (std::count(soft_.begin(), soft_.end(), true) > 0 || soft_floor_) add("min_det_f", "above", "1e-6");
    add("newton_iterations", "below", "301");
    // With friction a step is solved to lag_tolerance only, and so is its energy; BDF2 is no minimiser of an energy that falls.
    if (!is_static_ && !loaded_) add("energy_gain", "below", friction_ ? "1e-2" : bdf2_ ? "1e-3" : "1e-5");
  }

  Dice d_;
  unsigned long seed_;
  std::string folder_;
  Scales s_{1};
  YAML::Node scene_;
  std::vector<std::string> names_;  // the floor last
  std::vector<bool> soft_;
  bool is_static_ = false, bdf2_ = false, crowd_ = false, half_space_ = false, soft_floor_ = false, friction_ = false, loaded_ = false,
       automatic_ = true;
  int bodies_ = 0, steps_ = 0;
  double step_ = 0, density_ = 0, modulus_ = 0, softest_ = 0, z_ = 0;
};

}  // namespace

Case wild_case(unsigned long seed, const std::string& folder) { return Wild(seed, folder).make(); }

}  // namespace mortise::bench::hard
