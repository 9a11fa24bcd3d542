#pragma once
// What holds bodies: how they hang on pinned bodies and on the world by joints, bonds and mortar ties, and by how much motors on that way give.
//
// A force F on a body has the moment tau_j about the coordinate x_j of each joint on the way (of a slide the component along it). Where the motor of
// that joint has the stiffness K_j, the place where F acts gives by e along F:
//
//     e |F| = sum_j tau_j^2 / K_j,     K_j = kp + S + M/w b''          kp: of a motor of mode pd; S: of the joint's spring; M/w b'': of its stop
//
// K_j is infinite of kinematic drives and fixed joints. A motor that wants more than its `effort` gives that and no more, wherever the joint is: it
// has no kp then, provided that it still wants as much once the joint has gone on by the gap of the contact layer. Joints that mimic add to the
// moment of the one that leads, times their ratios.
// Left out: kd and inertia, by which a motor is stiffer while it moves than where it has come to rest; loops are followed one way round.
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/params.h"
#include "geometry/rigid_motion.h"

namespace mortise::audit {

class Holds {
 public:
  explicit Holds(const Params& effects);

  // What the scene says of the motor of a joint, or of its bearing.
  struct Motor {
    bool kinematic = false, passive = false, effort_only = false;
    double kp = 0, kd = 0, effort = INFINITY, spring = 0, damping = 0, armature = 0;
    bool has_gains() const { return !kinematic && !passive && !effort_only; }
    bool swings() const { return has_gains() || (passive && spring > 0); }  // about its target, or where its spring is at ease
  };
  const Motor& motor_of(const std::string& joint) const { return motors_.at(joint); }

  bool held(const std::string& body) const { return ways_.count(body) > 0; }
  bool pinned(const std::string& body) const;
  // Does it go as the scene says: pinned, or all of whose joints on the way are fixed or have kinematic drives?
  bool given(const std::string& body) const;
  // Is there a motor on the way to what holds it, or to the first body that is given? Springs alone are none.
  bool motored(const std::string& body) const;
  // Do motor, spring and damper of the first joint on the way that moves damp by far more than a time step of backward Euler does, whose share
  // of damping is h times the stiffness? step: h [s].
  bool damped(const std::string& body, double step) const;
  // Does it hang, by joints that all are fixed, kinematic or have motors with gains or springs, on what holds it?
  bool goes_by_gains(const std::string& body) const;
  using Motions = std::function<geometry::Motion(const std::string& body)>;  // from rest to now
  // What a unit of the coordinate of each joint that leads moves a held body with, whose centre this is; by the joint's name.
  std::map<std::string, geometry::RigidVelocity> moved_by(const std::string& body, const Motions& motion, const Vec3& centre) const;
  // What drives a joint: a motor of given torque or force, or one that goes after a target, a speed or what leads it. Springs and dampers alone are
  // none.
  enum class Driven { no, by_effort, yes };
  Driven driven(const std::string& joint) const;
  // Of a soft body that a mortar tie holds: the one that it is tied to; null of others.
  const std::string* tied_to(const std::string& body) const;
  // Pairs of bodies that joints, bonds or ties keep together.
  const std::vector<std::pair<std::string, std::string>>& together() const { return together_; }

  // On a body: force [N], moment about the world's origin [N m], and the gap in the contact that it is of [m].
  struct Load {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    double gap = 0;
  };
  struct State {
    const std::map<std::string, double>& number;  // what joints and drives report
    Motions motion;
    std::function<double(const std::string& body, const Vec3& at)> distance;  // of the middle of a body from a place
  };
  // Of a held body: e [m], infinite where something is free that the force moves; and, of what is free, the force along its coordinate, of a hinge
  // the moment over the body's distance [N].
  struct Give {
    double way = 0, along = 0;
  };
  Give give(const std::string& body, const Load& load, const State& state) const;

 private:
  struct Joint {
    std::string name, body, to;  // to: empty is the world
    bool spherical = false, fixed = false, slides = false;
    Vec3 at = Vec3::Zero(), axis = Vec3::Zero();
    std::string leader;
    double ratio = 1;
    double low = -INFINITY, high = INFINITY;  // its stops
    bool has_coordinate() const { return !spherical && !fixed; }
  };
  // A joint as it stands, seen from one of its bodies.
  struct Standing {
    const Joint& joint;
    Vec3 place, axis;
    double side;  // 1 from its `body`, -1 from its `to`
  };
  // The next body on the way to what holds; by which joint, or none (-1).
  struct Step {
    std::string to;
    long joint = -1;
    bool tie = false;
  };
  struct Coordinate {
    double moment = 0, spring = 0, size = 0;
  };
  // Do all joints on the way from a held body to what holds it pass a test?
  bool each_joint(const std::string& body, const std::function<bool(const Joint&)>& passes) const;
  // The joints on that way, nearest first, for as long as `look` says so.
  void each_standing(const std::string& body, const Motions& motion, const std::function<bool(const Standing&)>& look) const;
  // The motor of a joint or of the one that leads it; null without one.
  const Motor* motor(const Joint& joint) const;
  // Who leads a joint, by how much: the end of its chain of mimicry.
  std::pair<const Joint*, double> leader(const Joint& joint) const;
  double stiffness(const Joint& joint, double moment, const Load& load, const State& state) const;
  double stop(const Joint& joint, const State& state) const;

  std::vector<Joint> joints_;
  std::map<std::string, std::size_t> by_name_;
  std::map<std::string, Motor> motors_;
  std::map<std::string, Step> ways_;
  std::vector<std::pair<std::string, std::string>> together_;
};

}  // namespace mortise::audit
