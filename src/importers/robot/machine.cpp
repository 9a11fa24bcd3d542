#include "importers/robot/machine.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/rigid_motion.h"
#include "geometry/topology.h"
#include "importers/robot/inertial.h"
#include "importers/robot/names.h"
#include "importers/robot/solid.h"
#include "importers/robot/standing.h"
#include "importers/robot/tuning.h"
#include "importers/robot/weigh.h"
#include "scene/suggest.h"

namespace mortise::importers {
namespace {

constexpr std::ptrdiff_t kWorld = -1;

class Assembly {
 public:
  Assembly(const Robot& robot, const MachineOptions& options, Notes& notes) : robot_(robot), options_(options), notes_(notes) {}

  Machine machine() {
    out_.name = scene_name(robot_.name);
    group();
    stand_ = stand(robot_, options_);
    for (std::size_t b = 0; b < out_.bodies.size(); ++b) {
      out_.bodies[b].at = stand_.in_world[frame_[b]];
      shape_of(b);
      mass_of(out_.bodies[b]);
    }
    axes();
    loops();
    pads();
    for (const auto& [a, b] : robot_.apart)
      for (const std::size_t i : parts(a))
        for (const std::size_t j : parts(b)) out_.apart.emplace_back(i, j);
    lift();
    return std::move(out_);
  }

 private:
  const Joint& joint_of(std::size_t link) const { return robot_.joints[robot_.joint_of[link]]; }
  // What asks for a link to be soft; null where nothing does.
  const SoftLink* soft(std::size_t link) const {
    const SoftLink* out = nullptr;
    for (const SoftLink& s : options_.soft)
      if (matches(s.link, robot_.links[link].name)) out = &s;
    return out;
  }
  bool softened(std::size_t link) const { return soft(link) != nullptr; }

  // Which links are one body, and where they are in it. A root called 'world' is the world.
  void group() {
    std::vector<std::string> names;
    for (const Link& l : robot_.links) names.push_back(l.name);
    const auto known = [&](const std::string& link) {
      if (std::none_of(names.begin(), names.end(), [&](const std::string& n) { return matches(link, n); }))
        throw Error(Exit::usage, options_.asked_soft + link + ": the robot has no such link; " + scene::suggestion(link, names));
    };
    for (const SoftLink& s : options_.soft) known(s.link);
    for (const auto& [link, colour] : options_.colours) known(link);
    body_.assign(robot_.links.size(), kWorld);
    in_body_.assign(robot_.links.size(), Pose{});
    Names taken;
    const std::vector<std::uint8_t> bases = options_.held ? held_bases() : std::vector<std::uint8_t>(robot_.links.size(), 0);
    for (const std::size_t link : robot_.order) {
      const Link& l = robot_.links[link];
      const bool root = link == robot_.root, world = root && l.name == "world" && !l.inertial;
      if (world && l.collisions.empty() && l.visuals.empty()) continue;
      if (!root && joint_of(link).type == Joint::Type::fixed) {
        const Joint& j = joint_of(link);
        if (body_[j.parent] != kWorld || softened(link)) {
          body_[link] = body_[j.parent], in_body_[link] = in_body_[j.parent] * j.origin;
          if (softened(link)) {
            if (body_[link] == kWorld) throw Error(Exit::usage, options_.asked_soft + l.name + ": what it is fixed to is the world, not a body");
            soft_.push_back(link);
          } else {
            merge(out_.bodies[body_[link]], l, in_body_[link]);
          }
          continue;
        }
      } else if (softened(link)) {
        throw Error(Exit::usage, options_.asked_soft + l.name + ": only a link that a fixed joint ties to its parent can become soft; this one " +
                                     (root ? "is the root" : "has joint '" + joint_of(link).name + "'"));
      }
      Body b;
      b.name = taken.of(l.name), b.where = l.where, b.bearing = l.bearing;
      const bool loose = !world && (root || joint_of(link).type == Joint::Type::floating);
      const bool fixed = world || (!root && joint_of(link).type == Joint::Type::fixed);
      b.held = fixed || (loose && bases[link]);
      fixed_to_world_ = fixed_to_world_ || fixed;
      body_[link] = static_cast<std::ptrdiff_t>(out_.bodies.size());
      merge(b, l, Pose{});
      frame_.push_back(link);
      out_.bodies.push_back(std::move(b));
    }
    for (std::size_t s : soft_)
      for (const Joint& j : robot_.joints)
        if (j.parent == s)
          throw Error(Exit::usage, options_.asked_soft + robot_.links[s].name + ": joint '" + j.name +
                                       "' hangs on it; only the last link of a limb can become soft");
  }

  // Links that move freely with joints below them: robots' bases. Where there is none the first that moves freely.
  std::vector<std::uint8_t> held_bases() const {
    std::vector<std::uint8_t> out(robot_.links.size(), 0);
    std::vector<std::size_t> base(robot_.links.size()), loose;
    for (const std::size_t link : robot_.order) {
      const bool root = link == robot_.root, free = root ? robot_.links[link].name != "world" : joint_of(link).type == Joint::Type::floating;
      base[link] = root || free ? link : base[joint_of(link).parent];
      if (free) loose.push_back(link);
      if (!root && (joint_of(link).moves() || joint_of(link).type == Joint::Type::spherical)) out[base[link]] = 1;
    }
    if (!loose.empty() && std::none_of(loose.begin(), loose.end(), [&](std::size_t link) { return out[link] != 0; })) out[loose[0]] = 1;
    return out;
  }

  std::optional<Vec3> colour_of(const std::string& link) const {
    std::optional<Vec3> out;
    for (const auto& [pattern, colour] : options_.colours)
      if (matches(pattern, link)) out = colour;
    return out;
  }

  void merge(Body& b, const Link& l, const Pose& at) {
    b.links.push_back(l.name);
    if (const std::optional<Vec3> asked = colour_of(l.name)) b.colour = asked, b.one_colour = true;
    if (l.inertial) b.inertial = together(b.inertial, moved(*l.inertial, at));
    if (!b.colour && l.visuals.empty()) b.colour = l.colour;
    b.undrawn = b.undrawn || l.undrawn;
    for (Shape s : l.visuals) {
      s.at = at * s.at;
      if (!b.colour) b.colour = s.colour;
      b.visuals.push_back(s);
    }
    for (Shape s : l.collisions) {
      if (!b.colour) b.colour = s.colour;
      s.at = at * s.at;
      if (l.visuals.empty()) b.unseen.push_back(s), b.unseen.back().colour = l.colour ? l.colour : s.colour;
      b.shapes.push_back(std::move(s));
    }
  }

  // A body needs a surface: what touches, else what is seen, else a small ball.
  void shape_of(std::size_t index) {
    Body& b = out_.bodies[index];
    if (b.undrawn && !b.visuals.empty()) b.visuals.insert(b.visuals.end(), b.unseen.begin(), b.unseen.end());
    if (!b.shapes.empty()) return;
    for (const Shape& shape : b.visuals)
      if (shape.kind != Shape::Kind::mesh && shape.kind != Shape::Kind::ellipsoid) b.shapes.push_back(shape);
    if (!b.shapes.empty()) {
      notes_.add(b.where, "a link without collision shape touches with its visual shapes");
      return;
    }
    if (!b.bearing) b.shapes = skeleton(index);
    if (!b.shapes.empty()) {
      notes_.add(b.where, "a link without a shape gets bars to the joints that hang on it");
      return;
    }
    Shape ball;
    ball.kind = Shape::Kind::sphere, ball.radius = b.bearing ? kBearingRadius : kStandInRadius, ball.at.t = b.inertial.centre, ball.where = b.where;
    b.shapes.push_back(ball);
    if (b.bearing) return;
    notes_.add(b.where, "a link without a shape that can touch gets a ball of 10 mm at its centre of mass");
  }

  void mass_of(Body& b) {
    Inertial& in = b.inertial;
    if (!(in.mass > 0)) {
      double sum = 0;
      for (const Shape& s : b.shapes) sum += volume(s);
      in.mass = std::max(kDensity * sum, kLeastMass);
      if (!b.held) notes_.add(b.where, "a link that moves has no mass: its shapes are filled with 1000 kg/m^3");
      b.even = true;
      return;
    }
    if (in.mass < kLeastMass) {
      notes_.add(in.where, "a mass below 1 g is taken as 1 g, and its inertia with it");
      in.tensor *= kLeastMass / in.mass, in.mass = kLeastMass;
    }
    if (!(in.tensor.trace() > 0)) {
      if (!b.held) notes_.add(in.where, "moments of inertia of zero: the mass fills the link's shapes evenly");
      b.even = true;
      return;
    }
    const Mat3 S = geometry::second_moment_of(in.tensor);  // positive for every body
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(S);
    const double least = kThinnest * 0.5 * in.tensor.trace();
    if (eigen.eigenvalues()[0] >= least) return;
    const Vec3 mended = eigen.eigenvalues().cwiseMax(least);
    const Mat3 M = eigen.eigenvectors() * mended.asDiagonal() * eigen.eigenvectors().transpose();
    in.tensor = M.trace() * Mat3::Identity() - M;
    notes_.add(in.where, "moments of inertia that no body has (one is not below the sum of the others) are mended");
  }

  void axes() {
    Names taken;
    std::vector<std::ptrdiff_t> axis_of(robot_.joints.size(), -1);
    for (const std::size_t link : robot_.order) {
      if (link == robot_.root || !(joint_of(link).moves() || joint_of(link).type == Joint::Type::spherical)) continue;
      const auto number = static_cast<std::size_t>(robot_.joint_of[link]);
      const Joint& j = robot_.joints[number];
      Axis a;
      a.name = taken.of(j.name), a.type = j.type, a.where = j.where;
      a.body = static_cast<std::size_t>(body_[link]), a.to = body_[j.parent];
      a.place = stand_.in_world[link](j.at);
      if (j.type == Joint::Type::prismatic) a.place -= (stand_.at[number] - j.zero) * (stand_.in_world[link].R * j.axis);
      a.direction = stand_.in_world[link].R * j.axis;
      a.stands = stand_.at[number], a.limits = j.limits;
      a.kp = j.kp, a.kd = j.kd, a.effort = j.effort, a.velocity = j.velocity, a.damping = j.damping, a.friction = j.friction;
      a.stiffness = j.stiffness, a.rest = j.rest, a.armature = j.armature;
      if (stand_.looped[number]) loosen(a);
      a.swing = swing(a), a.passive = j.passive && options_.sway == 0;
      axis_of[number] = static_cast<std::ptrdiff_t>(out_.axes.size());
      out_.axes.push_back(a);
    }
    for (std::size_t i = 0; i < robot_.joints.size(); ++i)
      if (const Joint& j = robot_.joints[i]; j.mimic && axis_of[i] >= 0) mimic(out_.axes[axis_of[i]], j, axis_of[j.mimic->leader]);
  }

  // A joint of a loop stands where the file has it, be that at its limit.
  void loosen(Axis& a) {
    if (!a.limits) return;
    auto& [low, high] = *a.limits;
    const double room = kFromLimit * std::min(kStopRange[a.type == Joint::Type::prismatic], (high - low) / 20);
    if (low + 0.5 * room < a.stands && a.stands < high - 0.5 * room) return;
    notes_.add(a.where, "a joint of a loop stands at its limit, or beyond it: the limit is moved away from there");
    low = std::min(low, a.stands - room), high = std::max(high, a.stands + room);
  }

  double swing(const Axis& a) const {
    const double widest = widest_swing(options_, a.type);
    return a.limits ? std::max(0.0, std::min(widest, kSwayRoom * std::min(a.stands - a.limits->first, a.limits->second - a.stands))) : widest;
  }

  void mimic(Axis& a, const Joint& j, std::ptrdiff_t leader) {
    if (a.limits && !(a.limits->first < a.stands && a.stands < a.limits->second)) a.limits.reset();
    if (leader < 0) {
      notes_.add(j.where, "a joint that mimics one which does not move has a motor that holds it there");
      a.swing = 0;
      return;
    }
    a.mimics = leader, a.ratio = j.mimic->multiplier;
    // The leader's swing leaves this one between its limits; its own limits hold for both where they are as far.
    Axis& other = out_.axes[leader];
    if (a.ratio != 0) other.swing = std::min(other.swing, a.swing / std::abs(a.ratio));
    a.swing = 0, a.passive = a.passive || !other.passive;
    if (other.limits && a.limits) {
      const double ends[2] = {a.stands + a.ratio * (other.limits->first - other.stands), a.stands + a.ratio * (other.limits->second - other.stands)};
      if (std::min(ends[0], ends[1]) >= a.limits->first && std::max(ends[0], ends[1]) <= a.limits->second) a.limits.reset();
    }
  }

  // Closing joints, in the world, where the first of their bodies has them.
  void loops() {
    Names taken;
    for (const Axis& a : out_.axes) taken.of(a.name);
    for (const Loop& l : robot_.loops) {
      ClosingJoint c{"", l.fixed, 0, body_[l.b], stand_.in_world[l.a](l.at)};
      std::ptrdiff_t body = body_[l.a];
      if (body == kWorld) std::swap(body, c.to);
      if (body == c.to) {
        notes_.add(l.where, "a loop that is closed within one body says nothing");
        continue;
      }
      c.name = taken.of(l.name), c.body = static_cast<std::size_t>(body);
      out_.loops.push_back(std::move(c));
    }
  }

  // A body needs a surface where the file has none, or none that was found: bars to the joints that hang on it, which show the robot's skeleton.
  std::vector<Shape> skeleton(std::size_t index) const {
    std::vector<Shape> out;
    for (const Joint& j : robot_.joints) {
      if (body_[j.parent] != static_cast<std::ptrdiff_t>(index) || body_[j.child] == body_[j.parent]) continue;
      const Vec3 way = in_body_[j.parent](j.origin.t);
      if (way.norm() < kShortestBar) continue;
      Shape& bar = out.emplace_back();
      bar.kind = Shape::Kind::cylinder, bar.radius = std::clamp(kBarRadius * way.norm(), kBarRadii[0], kBarRadii[1]), bar.length = way.norm();
      bar.at = {geometry::turn_of_z(way), 0.5 * way}, bar.where = out_.bodies[index].where;
    }
    return out;
  }

  void pads() {
    Names taken;
    for (const Body& b : out_.bodies) taken.of(b.name);
    for (std::size_t link : soft_) {
      const Link& l = robot_.links[link];
      if (l.collisions.size() != 1)
        throw Error(Exit::usage, options_.asked_soft + l.name + ": it has " + (l.collisions.empty() ? "no" : std::to_string(l.collisions.size())) +
                                     " collision shapes; a pad is made of one");
      Pad p;
      p.name = taken.of(l.name), p.body = static_cast<std::size_t>(body_[link]), p.where = l.where;
      p.shape = l.collisions[0];
      p.shape.at = stand_.in_world[link] * p.shape.at;
      if (!l.visuals.empty()) p.colour = l.visuals[0].colour;
      if (const std::optional<Vec3> asked = colour_of(l.name)) p.colour = asked;
      const SoftLink& wanted = *soft(link);
      p.youngs_modulus = wanted.youngs_modulus, p.poisson_ratio = wanted.poisson_ratio, p.edge_length = wanted.edge_length;
      const double density = l.inertial ? l.inertial->mass / volume(p.shape) : 0;
      p.density = density >= kPadDensity[0] && density <= kPadDensity[1] ? density : kPadDensity[2];
      if (p.density != density) notes_.add(l.where, "a pad whose mass and volume make no solid is given 1100 kg/m^3");
      out_.pads.push_back(p);
    }
  }

  // What a link became: part of a body, or a pad.
  std::vector<std::size_t> parts(std::size_t link) const {
    const auto pad = std::find(soft_.begin(), soft_.end(), link);
    if (pad != soft_.end()) return {out_.bodies.size() + static_cast<std::size_t>(pad - soft_.begin())};
    return body_[link] == kWorld ? std::vector<std::size_t>{} : std::vector<std::size_t>{static_cast<std::size_t>(body_[link])};
  }

  // Clear of the floor. A robot that its file ties to the world is where the file says, and the floor below it.
  void lift() {
    double lowest = INFINITY;
    for (const Body& b : out_.bodies)
      for (const Shape& s : b.shapes) lowest = std::min(lowest, bounds(s, b.at * s.at).first[2]);
    for (const Pad& p : out_.pads) lowest = std::min(lowest, bounds(p.shape, p.shape.at).first[2]);
    if (tied_to_world()) {
      if (lowest >= options_.clearance) return;
      out_.floor = lowest - options_.clearance;
      notes_.add(robot_.links[robot_.root].where, "what the file ties to the world stays at its height: the floor lies below it, not at z = 0");
      return;
    }
    const Vec3 up(0, 0, options_.clearance - lowest);
    for (Body& b : out_.bodies) b.at.t += up;
    for (Axis& a : out_.axes) a.place += up;
    for (ClosingJoint& l : out_.loops) l.place += up;
    for (Pad& p : out_.pads) p.shape.at.t += up;
  }

  bool tied_to_world() const {
    const auto hangs = [](const auto& joint) { return joint.to < 0; };
    return fixed_to_world_ || std::any_of(out_.axes.begin(), out_.axes.end(), hangs) || std::any_of(out_.loops.begin(), out_.loops.end(), hangs);
  }

  const Robot& robot_;
  const MachineOptions& options_;
  Notes& notes_;
  Machine out_;
  std::vector<std::ptrdiff_t> body_;  // by link
  std::vector<Pose> in_body_;         // of every link
  std::vector<std::size_t> frame_;    // by body: the link whose frame it has
  std::vector<std::size_t> soft_;     // links
  bool fixed_to_world_ = false;       // some body, by the file
  Standing stand_;
};

}  // namespace

double Machine::mass() const {
  double sum = 0;
  for (const Body& b : bodies) sum += b.held ? 0 : b.inertial.mass;
  for (const Pad& p : pads) sum += p.density * volume(p.shape);
  return sum;
}

Machine assemble(const Robot& robot, const MachineOptions& options, Notes& notes) { return Assembly(robot, options, notes).machine(); }

}  // namespace mortise::importers
