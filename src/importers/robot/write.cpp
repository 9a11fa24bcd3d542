#include "importers/robot/write.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

#include "geometry/bounds.h"
#include "importers/robot/solid.h"
#include "importers/robot/tuning.h"
#include "scene/suggest.h"

namespace mortise::importers {
namespace {

// Nine digits: a nanometre in a metre, and nobody has to read 0.30000000000000004.
std::string number(double x) {
  const std::string out = fmt::format("{:.9g}", std::abs(x) < 1e-12 ? 0.0 : x);
  return out == "-0" ? "0" : out;
}
std::string vector(const Vec3& v) { return fmt::format("[{}, {}, {}]", number(v[0]), number(v[1]), number(v[2])); }
std::string length(double x) { return std::abs(x) < 1 ? number(1e3 * x) + " mm" : number(x) + " m"; }
std::string angle(double x) {
  const double degrees = x * 180 / std::numbers::pi;
  return std::abs(degrees - std::round(100 * degrees) / 100) < 1e-7 ? number(std::round(100 * degrees) / 100) + " deg" : number(x);
}
std::string quoted(const std::string& s) {
  std::string out = "\"";
  for (char c : s) out += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + "\"";
}
std::string rounded(double x) { return fmt::format("{:.4g}", x); }

// ", position: ..., rotation: ..." of what is not at its origin.
std::string placed(const Pose& at, const char* separator) {
  std::string out;
  if (at.t.norm() > 1e-12) out += separator + std::string("position: ") + vector(at.t);
  const Eigen::AngleAxisd turn(at.R);
  if (std::abs(turn.angle()) > 1e-9) {
    Vec3 axis = turn.axis();
    for (double& x : axis) x = std::abs(x) < 1e-9 ? 0 : x;
    out += separator + fmt::format("rotation: {{axis: {}, angle: {}}}", vector(axis), angle(turn.angle()));
  }
  return out;
}

class Writer {
 public:
  Writer(const Machine& m, const std::vector<PassingPair>& passing, const std::string& path) : m_(m), passing_(passing), path_(path) {
    for (const Body& b : m.bodies)
      for (const Shape& s : b.shapes) include(bounds(s, b.at * s.at));
    for (const Pad& p : m.pads) include(bounds(p.shape, p.shape.at));
    if (m.gait) include({around_.lo + Vec3::UnitX() * way(), around_.hi + Vec3::UnitX() * way()});
  }

  std::string scene(const std::string& command) {
    line("# Written by: " + command);
    line(fmt::format(
        "# {} bodies, {} joints{}, {:.4g} kg that move. Where bodies stand and what is chosen for want of it in the file (motors' gains, contact,",
        m_.bodies.size(), m_.axes.size(), m_.pads.empty() ? "" : fmt::format(", {} soft pads", m_.pads.size()), m_.mass()));
    line(
        "# friction, cameras) is meant to be edited. A motor's target may be keys {time: [...], value: [...]} or a column of a CSV or HDF5 file: "
        "mortise "
        "effects drive.");
    line("mortise: 1");
    line("name: " + m_.name);
    line("");
    const double lasts = m_.gait ? kGaitBegin + kGaitRamp + kGaitCycles * m_.gait->period : 1;
    line(fmt::format("time: {{step: 5 ms, steps: {}, frame_every: 10}}", static_cast<int>(std::ceil(lasts / 0.005 - 1e-9))));
    line("");
    if (!m_.pads.empty()) materials();
    bodies();
    pairs();
    effects();
    cameras();
    return out_;
  }

 private:
  void line(const std::string& text) { out_ += text + "\n"; }
  // How far it steps, if nothing slips and motors keep up.
  double way() const { return m_.gait->stride * (0.5 * kGaitRamp / m_.gait->period + kGaitCycles) / m_.gait->duty; }
  void include(const std::pair<Vec3, Vec3>& b) { around_.include(b.first), around_.include(b.second); }

  std::string file(const std::string& mesh) const {
    namespace fs = std::filesystem;
    const fs::path folder = fs::absolute(path_).lexically_normal().parent_path();
    const std::string near = fs::path(mesh).lexically_proximate(folder).string();
    return quoted(near.rfind("../../..", 0) == 0 ? mesh : near);
  }

  std::string shape(const Shape& s, double h) const {
    const std::string edge = length(h);
    switch (s.kind) {
      case Shape::Kind::box:
        return fmt::format("{{box: {{size: {}, edge_length: {}}}}}", vector(s.size), edge);
      case Shape::Kind::sphere:
        return fmt::format("{{sphere: {{radius: {}, edge_length: {}}}}}", length(s.radius), edge);
      case Shape::Kind::cylinder:
      case Shape::Kind::capsule:
        return fmt::format("{{{}: {{radius: {}, height: {}, edge_length: {}}}}}", s.kind == Shape::Kind::cylinder ? "cylinder" : "capsule",
                           length(s.radius), length(s.length), edge);
      case Shape::Kind::ellipsoid:
      case Shape::Kind::mesh:
        break;
    }
    const std::string scale = s.scale[0] == 1 ? "" : ", scale: " + number(s.scale[0]);
    return fmt::format("{{mesh: {{file: {}{}}}}}", file(s.file), scale);
  }

  void materials() {
    line("materials:");
    for (std::size_t p = 0; p < m_.pads.size(); ++p) {
      if (p != same_material(p)) continue;
      line(fmt::format("  {}: {{youngs_modulus: {} MPa, poisson_ratio: {}, density: {} kg/m^3}}", rubber(p),
                       rounded(m_.pads[p].youngs_modulus * 1e-6), rounded(m_.pads[p].poisson_ratio), rounded(m_.pads[p].density)));
    }
    line("");
  }
  std::size_t same_material(std::size_t p) const {
    const auto of = [](const Pad& pad) { return rounded(pad.density) + " " + rounded(pad.youngs_modulus) + " " + rounded(pad.poisson_ratio); };
    std::size_t first = 0;
    while (of(m_.pads[first]) != of(m_.pads[p])) ++first;
    return first;
  }
  std::string rubber(std::size_t p) const {
    const std::size_t first = same_material(p);
    return first == 0 ? "rubber" : "rubber_" + m_.pads[first].name;
  }

  void bodies() {
    line("bodies:");
    for (const Body& b : m_.bodies) body(b);
    for (std::size_t p = 0; p < m_.pads.size(); ++p) pad(p);
    line("  floor: {type: half_space" + (m_.floor == 0 ? "" : ", point: " + vector({0, 0, m_.floor})) + "}");
    line("");
  }

  void body(const Body& b) {
    line("  " + b.name + ":" + (b.links.size() > 1 ? "  # " + scene::join(b.links, ", ") : b.name != b.links[0] ? "  # " + b.links[0] : ""));
    line("    type: stiff");
    const Shape& first = b.shapes[0];
    if (b.shapes.size() == 1 && placed(first.at, "").empty()) {
      line("    shape: " + shape(first, edge_length(first)));
    } else {
      line("    shape:");
      line("      parts:");
      for (const Shape& s : b.shapes) line("        - {shape: " + shape(s, edge_length(s)) + placed(s.at, ", ") + "}");
    }
    const Inertial& in = b.inertial;
    line("    mass: " + number(in.mass) + " kg");
    if (!b.even) {
      const Mat3& I = in.tensor;
      const Vec3 products(I(0, 1), I(0, 2), I(1, 2));
      line(fmt::format("    inertia: {{centre: {}, moments: {}{}}}", vector(in.centre), vector(I.diagonal()),
                       products.isZero(0) ? "" : ", products: " + vector(products)));
    }
    const std::string where = placed(b.at, "\n    ");
    if (!where.empty()) line(where.substr(1));
    std::string visual = "color: " + vector(b.colour.value_or(Vec3(0.7, 0.7, 0.7)));
    if (b.drawn) {
      visual += ", mesh: " + file(b.drawn->file) + placed(b.drawn->at, ", ");
      visual += ", scale: " + number(b.drawn->scale[0]);
    }
    line("    visual: {" + visual + "}");
  }

  void pad(std::size_t index) {
    const Pad& p = m_.pads[index];
    const double h = p.edge_length > 0 ? p.edge_length : pad_cell(p.shape);
    line("  " + p.name + ":");
    line("    type: soft");
    std::string text = shape(p.shape, h);
    if (p.shape.kind == Shape::Kind::mesh) text.insert(text.size() - 2, ", edge_length: " + length(h));
    line("    shape: " + text);
    line("    material: " + rubber(index));
    line("    self_contact: false");
    const std::string where = placed(p.shape.at, "\n    ");
    if (!where.empty()) line(where.substr(1));
    line("    visual: {color: " + vector(p.colour.value_or(Vec3(0.2, 0.2, 0.22))) + "}");
  }

  static double pad_cell(const Shape& shape) {
    const auto [lo, hi] = bounds(shape, Pose{});
    return std::round(1e5 * std::cbrt((hi - lo).prod()) / kPadCells) / 1e5;
  }

  const std::string& name(std::size_t i) const { return i < m_.bodies.size() ? m_.bodies[i].name : m_.pads[i - m_.bodies.size()].name; }
  void pairs() {
    if (passing_.empty()) return;
    line("# What passes through each other besides neighbours: with few joints between them, by the robot's file, or overlapping as they stand.");
    line("pairs:");
    for (const PassingPair& p : passing_)
      line(fmt::format("  - {{bodies: [{}, {}], collide: false}}{}", name(p.a), name(p.b), p.why == PassingPair::Why::overlap ? "  # overlap" : ""));
    line("");
  }

  void effects() {
    const auto any = [](const auto& list, auto what) { return std::any_of(list.begin(), list.end(), what); };
    line("effects:");
    line("  inertia: {integrator: bdf2}  # where robots walk and what motors give errs several times less than with backward_euler");
    line("  gravity: {}");
    line("  affine_body: {}");
    if (!m_.pads.empty()) line("  elasticity: {}");
    if (any(m_.bodies, [](const Body& b) { return b.held; })) {
      line("  pin:");
      for (const Body& b : m_.bodies)
        if (b.held) line(fmt::format("    - {{body: {}, where: {{side: all}}}}", b.name));
    }
    if (!m_.axes.empty() || !m_.loops.empty()) {
      line("  joint:");
      for (const Axis& a : m_.axes) joint(a);
      for (const ClosingJoint& l : m_.loops)
        line(fmt::format("    - {{name: {}, type: {}, body: {}{}, at: {}}}", l.name, l.fixed ? "fixed" : "spherical", m_.bodies[l.body].name,
                         l.to >= 0 ? ", to: " + m_.bodies[l.to].name : "", vector(l.place)));
    }
    const auto driven = [](const Axis& a) {
      const bool bare = a.passive && a.damping == 0 && a.friction == 0 && a.stiffness == 0 && a.armature == 0;
      return a.type != Joint::Type::spherical && !bare;
    };
    if (any(m_.axes, driven)) {
      line("  drive:");
      for (const Axis& a : m_.axes)
        if (driven(a)) drive(a);
    }
    if (!m_.pads.empty()) {
      line("  bond:");
      for (const Pad& p : m_.pads) bond(p);
    }
    line("  barrier_contact: {}");
    line("  friction: {follows: barrier_contact, mu: 0.8}");
    line("");
  }

  void joint(const Axis& a) {
    const bool turns = a.type == Joint::Type::revolute, ball = a.type == Joint::Type::spherical;
    std::string text = fmt::format("name: {}, type: {}, body: {}", a.name,
                                   ball    ? "spherical"
                                   : turns ? "revolute"
                                           : "prismatic",
                                   m_.bodies[a.body].name);
    if (a.to >= 0) text += ", to: " + m_.bodies[a.to].name;
    text += ", at: " + vector(a.place);
    if (!ball) text += ", axis: " + vector(a.direction);
    if (a.mimics >= 0) text += fmt::format(", mimic: {{joint: {}, ratio: {}}}", m_.axes[a.mimics].name, number(a.ratio));
    if (std::abs(a.stands) > 1e-12) text += std::string(turns ? ", angle: " + angle(a.stands) : ", travel: " + length(a.stands));
    if (a.limits) {
      const auto limit = [&](double x) { return turns ? angle(x) : length(x); };
      text += fmt::format(", {}: [{}, {}]", turns ? "angle_limits" : "travel_limits", limit(a.limits->first), limit(a.limits->second));
    }
    line("    - {" + text + "}");
  }

  std::string resistance(const Axis& a) const {
    std::string out;
    if (a.damping > 0) out += ", damping: " + number(a.damping);
    if (a.friction > 0) out += ", friction: " + number(a.friction);
    if (a.stiffness > 0) out += ", stiffness: " + number(a.stiffness);
    if (a.stiffness > 0 && a.rest != 0) out += ", rest: " + (a.type == Joint::Type::revolute ? angle(a.rest) : length(a.rest));
    if (a.armature > 0) out += ", armature: " + number(a.armature);
    return out;
  }

  void drive(const Axis& a) {
    const bool turns = a.type == Joint::Type::revolute;
    std::string text = "joint: " + a.name;
    if (a.passive) {
      line("    - {" + text + ", mode: passive" + resistance(a) + "}");
      return;
    }
    const double effort = a.effort > 0 ? a.effort : kHold * 9.81 * m_.mass() * (turns ? 0.1 : 1), kp = a.kp > 0 ? a.kp : effort / kFullEffort[!turns];
    text += fmt::format(", mode: pd, kp: {}, kd: {}", rounded(kp), rounded(a.kd > 0 ? a.kd : kSettling * kp));
    if (a.effort > 0) text += ", effort: " + number(a.effort);
    if (a.effort > 0 && a.velocity > 0) text += ", velocity: " + number(a.velocity);
    text += resistance(a);
    if (a.step) {
      line("    - {" + text + gait(*a.step) + "}");
      return;
    }
    text += turns ? ", angle: " + angle(a.stands) : ", travel: " + length(a.stands);
    if (a.swing != 0)
      text += fmt::format(", sine: {{{}, frequency: {}}}", turns ? "angle: " + angle(a.swing) : "travel: " + length(a.swing), number(kSwayRate));
    line("    - {" + text + "}");
  }

  // What all legs have in common is written once.
  std::string gait(const Axis::Step& s) {
    const Machine::Gait& g = *m_.gait;
    const std::string common =
        std::exchange(gait_written_, true)
            ? "*steps"
            : fmt::format("&steps {{period: {} s, stride: {}, clearance: {}, duty: {}, begin: {} s, ramp: {} s}}", number(g.period), length(g.stride),
                          length(g.clearance), number(g.duty), number(kGaitBegin), number(kGaitRamp));
    return fmt::format(", gait: {{<<: {}, upper: {}, lower: {}, foot: {}, phase: {}}}", common, m_.axes[s.upper].name, m_.axes[s.lower].name,
                       vector(s.foot), number(s.phase));
  }

  // A ball has a core of half its size; anything else is held where it lies in its link or near to it.
  void bond(const Pad& p) {
    const std::string& to = m_.bodies[p.body].name;
    if (p.shape.kind == Shape::Kind::sphere)
      line(fmt::format("    - {{body: {}, to: {}, where: {{sphere: {{centre: {}, radius: {}}}}}}}", p.name, to, vector(p.shape.at.t),
                       length(0.5 * p.shape.radius)));
    else
      line(fmt::format("    - {{body: {}, to: {}, within: {}}}", p.name, to, length(0.25 * pad_cell(p.shape))));
  }

  void cameras() {
    const Vec3 middle = 0.5 * (around_.lo + around_.hi);
    const double size = around_.size().norm(), away = 1.7 * size;
    const auto near = [](const Vec3& x) { return vector(((1e3 * x).array().round() / 1e3).matrix()); };  // to a millimetre
    const auto from = [&](const Vec3& d) { return near(middle + away * d.normalized()); };
    line("render:");
    line("  cameras:");
    line("    front: {position: " + from({0.8, -1, 0.45}) + ", look_at: " + near(middle) + "}");
    line("    side: {position: " + from({0, -1, 0.1}) + ", look_at: " + near(middle) + "}");
  }

  const Machine& m_;
  const std::vector<PassingPair>& passing_;
  const std::string& path_;
  geometry::Bounds around_;
  bool gait_written_ = false;
  std::string out_;
};

}  // namespace

std::string write_scene(const Machine& machine, const std::vector<PassingPair>& passing, const std::string& path, const std::string& command) {
  return Writer(machine, passing, path).scene(command);
}

}  // namespace mortise::importers
