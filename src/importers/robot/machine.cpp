#include "importers/robot/machine.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/bounds.h"
#include "geometry/rigid_motion.h"
#include "geometry/topology.h"
#include "importers/robot/inertial.h"
#include "importers/robot/names.h"
#include "importers/robot/solid.h"
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
    stand();
    place();
    for (std::size_t b = 0; b < out_.bodies.size(); ++b) {
      out_.bodies[b].at = in_world_[frame_[b]];
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
      b.held = world || (loose && bases[link]) || (!root && joint_of(link).type == Joint::Type::fixed);
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

  // The coordinate of every joint: as asked for, else as near to zero as its limits let it stand. Of a hinge that cannot be straight the parallel one
  // before it takes half of the bend back: a leg of two equal links then ends below where it begins.
  void stand() {
    stands_.clear();
    for (const Joint& j : robot_.joints) stands_.push_back(j.zero);
    for (const auto& [pattern, value] : options_.stands)
      if (std::none_of(robot_.joints.begin(), robot_.joints.end(), [&, p = pattern](const Joint& j) { return j.moves() && matches(p, j.name); })) {
        std::vector<std::string> names;
        for (const Joint& j : robot_.joints)
          if (j.moves()) names.push_back(j.name);
        throw Error(Exit::usage, options_.asked_joint + pattern + ": no joint that moves is called so; " + scene::suggestion(pattern, names));
      }
    std::vector<std::uint8_t> free(robot_.joints.size(), 0);
    looped_ = in_loops();
    const bool held = options_.held || robot_.links[robot_.root].name == "world";
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const Joint& j = robot_.joints[i];
      if (!j.moves()) continue;
      bool asked = false;
      for (const auto& [pattern, value] : options_.stands)
        if (matches(pattern, j.name)) stands_[i] = value, asked = true;
      if (looped_[i] && asked)
        throw Error(Exit::usage, options_.asked_joint + j.name + ": it is part of a loop of joints, which stands as the file has it");
      if (looped_[i]) continue;
      if (!asked && j.stand) stands_[i] = *j.stand;
      free[i] = !asked && !j.stand && !j.mimic && j.type == Joint::Type::revolute;
      if (!j.limits || j.mimic) continue;
      const auto [low, high] = *j.limits;
      if (asked && !(low < stands_[i] && stands_[i] < high))
        throw Error(Exit::usage, options_.asked_joint + j.name + "=" + std::to_string(stands_[i]) + ": its limits are " + std::to_string(low) +
                                     " and " + std::to_string(high));
      const double range = std::min(kStopRange[j.type == Joint::Type::prismatic], (high - low) / 20);
      if (!asked) stands_[i] = std::clamp(stands_[i], low + kFromLimit * range, high - kFromLimit * range);
      if (!asked && !j.stand && options_.sway > 0 && held) {  // room to swing; who stands on the floor would fall
        const double room = widest_swing(j.type) / kSwayRoom;
        stands_[i] = high - low > 2 * room ? std::clamp(stands_[i], low + room, high - room) : 0.5 * (low + high);
      }
    }
    bend_back(free);
    for (std::size_t round = 0; round < robot_.joints.size(); ++round)  // leaders that follow others
      for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
        const Joint& j = robot_.joints[i];
        if (j.mimic && j.moves() && !looped_[i]) stands_[i] = j.mimic->multiplier * stands_[j.mimic->leader] + j.mimic->offset;
      }
  }
  // Joints on the ways between the two ends of a loop.
  std::vector<std::uint8_t> in_loops() const {
    std::vector<std::uint8_t> out(robot_.joints.size(), 0);
    for (const Loop& loop : robot_.loops) {
      std::vector<std::uint8_t> above(robot_.joints.size(), 0);
      const auto up = [&](std::size_t link, const auto& visit) {
        for (; robot_.joint_of[link] >= 0; link = robot_.joints[robot_.joint_of[link]].parent) visit(static_cast<std::size_t>(robot_.joint_of[link]));
      };
      up(loop.a, [&](std::size_t j) { above[j] = 1; });
      up(loop.b, [&](std::size_t j) { above[j] ^= 1; });
      for (std::size_t j = 0; j < out.size(); ++j) out[j] = out[j] != 0 || above[j] != 0;
    }
    return out;
  }
  void bend_back(const std::vector<std::uint8_t>& free) {
    constexpr double kParallel = 1e-3;
    const std::vector<double> bent = stands_;
    for (std::size_t i = 0; i < bent.size(); ++i) stands_[i] = robot_.joints[i].zero;
    place();  // axes as the file has them
    stands_ = bent;
    const auto axis = [&](const Joint& j) -> Vec3 { return in_world_[j.child].R * j.axis; };
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const Joint& j = robot_.joints[i];
      if (!free[i] || bent[i] == j.zero) continue;
      std::ptrdiff_t before = robot_.joint_of[j.parent];
      while (before >= 0 && robot_.joints[before].type == Joint::Type::fixed) before = robot_.joint_of[robot_.joints[before].parent];
      if (before < 0 || !free[before] || bent[before] != robot_.joints[before].zero || axis(robot_.joints[before]).cross(axis(j)).norm() > kParallel)
        continue;
      const double back = -0.5 * (bent[i] - j.zero) * (axis(robot_.joints[before]).dot(axis(j)) > 0 ? 1 : -1);
      const auto& limits = robot_.joints[before].limits;
      const double there = robot_.joints[before].zero + back;
      if (!limits || (limits->first + kStopRange[0] < there && there < limits->second - kStopRange[0])) stands_[before] = there;
    }
  }
  // Links in the world; the root's frame is the world's.
  void place() {
    in_world_.assign(robot_.links.size(), Pose{});
    for (const std::size_t link : robot_.order) {
      if (link == robot_.root) continue;
      const Joint& j = joint_of(link);
      const double s = stands_[robot_.joint_of[link]];
      in_world_[link] = in_world_[j.parent] * j.origin * j.motion(s);
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
      a.place = in_world_[link](j.at);
      if (j.type == Joint::Type::prismatic) a.place -= (stands_[number] - j.zero) * (in_world_[link].R * j.axis);
      a.direction = in_world_[link].R * j.axis;
      a.stands = stands_[number], a.limits = j.limits;
      a.kp = j.kp, a.kd = j.kd, a.effort = j.effort, a.velocity = j.velocity, a.damping = j.damping, a.friction = j.friction;
      a.stiffness = j.stiffness, a.rest = j.rest, a.armature = j.armature;
      if (looped_[number]) loosen(a);
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

  double widest_swing(Joint::Type type) const { return options_.sway * (type == Joint::Type::prismatic ? kSwaySlide : 1); }
  double swing(const Axis& a) const {
    const double widest = widest_swing(a.type);
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
      ClosingJoint c{"", l.fixed, 0, body_[l.b], in_world_[l.a](l.at)};
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
      p.shape.at = in_world_[link] * p.shape.at;
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

  // Clear of the floor. What hangs on the world hangs where the file says, unless that is in the floor.
  void lift() {
    double lowest = INFINITY;
    for (const Body& b : out_.bodies)
      for (const Shape& s : b.shapes) lowest = std::min(lowest, bounds(s, b.at * s.at).first[2]);
    for (const Pad& p : out_.pads) lowest = std::min(lowest, bounds(p.shape, p.shape.at).first[2]);
    const bool hangs = std::any_of(out_.axes.begin(), out_.axes.end(), [](const Axis& a) { return a.to < 0; });
    if (hangs && lowest >= options_.clearance) return;
    const Vec3 up(0, 0, options_.clearance - lowest);
    for (Body& b : out_.bodies) b.at.t += up;
    for (Axis& a : out_.axes) a.place += up;
    for (ClosingJoint& l : out_.loops) l.place += up;
    for (Pad& p : out_.pads) p.shape.at.t += up;
  }

  const Robot& robot_;
  const MachineOptions& options_;
  Notes& notes_;
  Machine out_;
  std::vector<std::ptrdiff_t> body_;  // by link
  std::vector<Pose> in_body_, in_world_;
  std::vector<std::size_t> frame_;    // by body: the link whose frame it has
  std::vector<std::size_t> soft_;     // links
  std::vector<double> stands_;        // by joint
  std::vector<std::uint8_t> looped_;  // by joint
};

}  // namespace

double Machine::mass() const {
  double sum = 0;
  for (const Body& b : bodies) sum += b.held ? 0 : b.inertial.mass;
  for (const Pad& p : pads) sum += p.density * volume(p.shape);
  return sum;
}

Machine assemble(const Robot& robot, const MachineOptions& options, Notes& notes) { return Assembly(robot, options, notes).machine(); }

std::pair<Vec3, Vec3> bounds(const Shape& s, const Pose& at) {
  if (s.kind == Shape::Kind::mesh) {
    const geometry::Bounds b = geometry::bounds_of(surface(s, at).points);
    return {b.lo, b.hi};
  }
  Vec3 half = Vec3::Constant(s.radius);
  if (s.kind == Shape::Kind::ellipsoid) half = 0.5 * (at.R * s.size.asDiagonal()).rowwise().norm();
  if (s.kind == Shape::Kind::box) half = 0.5 * (at.R.cwiseAbs() * s.size);
  if (s.kind == Shape::Kind::capsule) half += 0.5 * s.length * at.R.col(2).cwiseAbs();
  if (s.kind == Shape::Kind::cylinder)  // a disc of normal n reaches r sqrt(1 - n_i^2) along axis i
    for (int i = 0; i < 3; ++i) half[i] = 0.5 * s.length * std::abs(at.R(i, 2)) + s.radius * std::sqrt(std::max(0.0, 1 - at.R(i, 2) * at.R(i, 2)));
  return {at.t - half, at.t + half};
}

std::vector<PassingPair> passing_pairs(const Machine& m, int apart) {
  const std::size_t bodies = m.bodies.size(), n = bodies + m.pads.size();
  std::vector<std::vector<std::size_t>> beside(n);
  const auto join = [&](std::size_t a, std::size_t b) { beside[a].push_back(b), beside[b].push_back(a); };
  for (const Axis& a : m.axes)
    if (a.to >= 0) join(a.body, static_cast<std::size_t>(a.to));
  for (const ClosingJoint& l : m.loops)
    if (l.to >= 0) join(l.body, static_cast<std::size_t>(l.to));
  for (std::size_t p = 0; p < m.pads.size(); ++p) join(bodies + p, m.pads[p].body);
  const auto shapes = [&](std::size_t i) { return i < bodies ? m.bodies[i].shapes : std::vector<Shape>{m.pads[i - bodies].shape}; };
  std::vector<geometry::TriMesh> surfaces(n);
  for (std::size_t i = 0; i < n; ++i)
    for (const Shape& s : shapes(i)) geometry::append(surface(s, i < bodies ? m.bodies[i].at * s.at : s.at), surfaces[i]);
  const auto said = [&](std::size_t a, std::size_t b) {
    for (const auto& [c, d] : m.apart)
      if ((a == c && b == d) || (a == d && b == c)) return true;
    for (const Shape& s : shapes(a))
      for (const Shape& t : shapes(b))
        if (s.touches(t)) return false;
    return true;
  };
  std::vector<PassingPair> out;
  for (std::size_t a = 0; a < n; ++a) {
    std::vector<int> hops(n, -1);
    hops[a] = 0;
    std::vector<std::size_t> todo{a};
    for (std::size_t k = 0; k < todo.size(); ++k)
      for (std::size_t b : beside[todo[k]])
        if (hops[b] < 0) hops[b] = hops[todo[k]] + 1, todo.push_back(b);
    for (std::size_t b = a + 1; b < n; ++b) {
      if (hops[b] == 1) continue;  // a joint or bond says so already
      if (hops[b] > 1 && hops[b] <= apart)
        out.push_back({a, b, PassingPair::Why::near});
      else if (said(a, b))
        out.push_back({a, b, PassingPair::Why::said});
      else if (meet(surfaces[a], surfaces[b], kOverlap))
        out.push_back({a, b, PassingPair::Why::overlap});
    }
  }
  return out;
}

}  // namespace mortise::importers
