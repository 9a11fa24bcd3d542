#include "effects/joint/read.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "base/complaints.h"
#include "effects/joint/joint.h"
#include "effects/joint/tuning.h"

namespace mortise::effects::joint {

using param::of;
using param::optional;

const ParamTable kMimic{
    "joint mimic",
    "Another revolute or prismatic joint, that this one follows exactly from where both stand.",
    {param::required(of(Param::Kind::text, "joint", Unit::none, std::nullopt, "Its name.")),
     param::number("ratio", Unit::none, "1", -INFINITY,
                   "How far this joint goes for every radian or metre of the other [1; m/rad or rad/m between a slide and a hinge].")}};

const ParamTable table = tie_table(
    "joint", "Joints between stiff bodies, or to the world, without stiffness or tolerance.",
    {param::required(param::choice("type", {"fixed", "spherical", "revolute", "prismatic"}, "",
                                   "fixed: nothing moves; spherical: a ball joint; revolute: a hinge; prismatic: a slide.")),
     of(Param::Kind::text, "body", Unit::none, std::nullopt, "Name of a stiff body."),
     optional(of(Param::Kind::text, "to", Unit::none, std::nullopt, "Name of the stiff body that it is joined to; without it the world.")),
     optional(of(Param::Kind::vec3, "at", Unit::length, std::nullopt,
                 "Where the joint is, world coordinates at rest; a fixed or prismatic one needs none.")),
     optional(of(Param::Kind::vec3, "axis", Unit::none, std::nullopt, "Axis of a revolute or prismatic joint, world coordinates at rest.")),
     optional(
         of(Param::Kind::number, "angle", Unit::angle, std::nullopt,
            "Of a revolute joint: the angle of `body` against `to`, right-handed about the axis, as the bodies stand in the scene; without it 0.")),
     optional(
         of(Param::Kind::numbers, "angle_limits", Unit::angle, std::nullopt, "Least and largest angle of a revolute joint, which it never reaches.")),
     optional(of(Param::Kind::number, "travel", Unit::length, std::nullopt,
                 "Of a prismatic joint: how far `body` is along the axis, against `to`, as the bodies stand in the scene; without it 0.")),
     optional(of(Param::Kind::numbers, "travel_limits", Unit::length, std::nullopt,
                 "Least and largest travel of a prismatic joint, which it never reaches.")),
     param::table("mimic", &kMimic, "Of a revolute or prismatic joint: it goes as another one does."),
     param::positive(optional(of(Param::Kind::number, "stop_effort", Unit::none, std::nullopt,
                                 "Torque [N m] or force [N] with which a stop pushes back where some half of its range, the last 0.02 degrees or "
                                 "0.02 mm, is left; it grows without bound. Without it a figure of the bodies' weights.")))});

namespace {

// One entry of the scene in one environment.
struct Joint {
  const Params* entry;
  Type type;
  Index body, to;
  Vec3 at, axis = Vec3::Zero();
  double stands = 0, low = -INFINITY, high = INFINITY;  // of the coordinate
};

void read_coordinate(const Params& p, Joint& j) {
  const bool turns = j.type == Type::revolute, slides = j.type == Type::prismatic;
  const auto without = [&](const char* key, bool has) {
    if (!has && p.has(key)) throw Error(Exit::scene, p.at(key).where(), std::string(key) + " has no meaning in a " + p.text("type") + " joint");
  };
  for (const char* key : {"angle", "angle_limits"}) without(key, turns);
  for (const char* key : {"travel", "travel_limits"}) without(key, slides);
  for (const char* key : {"stop_effort", "mimic"}) without(key, turns || slides);
  const char *stands = turns ? "angle" : "travel", *limited = turns ? "angle_limits" : "travel_limits", *unit = turns ? " rad" : " m";
  if (p.has(stands)) j.stands = p.number(stands);
  if (!p.has(limited)) {
    if (p.has("stop_effort"))
      throw Error(Exit::scene, p.at("stop_effort").where(),
                  std::string("stop_effort has no meaning without ") + (turns ? "angle_limits" : "travel_limits"));
    return;
  }
  const Params& limits = p.at(limited);
  const std::vector<double> ends = limits.as_numbers();
  if (ends.size() != 2 || !(ends[0] < ends[1]))
    throw Error(Exit::scene, limits.where(), std::string(limited) + " must be two increasing " + (turns ? "angles" : "lengths"));
  j.low = ends[0], j.high = ends[1];
  if (j.low < j.stands && j.stands < j.high) return;
  throw Error(Exit::scene, limits.where(),
              "the joint stands at " + std::to_string(j.stands) + unit + ", which is not between its limits " + std::to_string(j.low) + " and " +
                  std::to_string(j.high) + unit + ": place its bodies otherwise, or say with '" + stands + "' where they stand");
}

Joint read_entry(const Params& p, const model::Model& model, Index body, Index to) {
  if (model.bodies[body].type != model::BodyType::stiff)
    throw Error(Exit::scene, p.at("body").where(), "'" + p.text("body") + "' is soft; joints are between stiff bodies (a bond ties soft ones)");
  const std::string& name = p.text("type");
  Joint j{&p,
          name == "fixed"       ? Type::fixed
          : name == "spherical" ? Type::spherical
          : name == "revolute"  ? Type::revolute
                                : Type::prismatic,
          body, to, model.bodies[body].centre};
  if (p.has("at"))
    j.at = p.vec3("at");
  else if (j.type == Type::spherical || j.type == Type::revolute)
    throw Error(Exit::scene, p.where(), "a " + name + " joint needs 'at', where it is");
  if (j.type == Type::revolute || j.type == Type::prismatic) {
    if (!p.has("axis")) throw Error(Exit::scene, p.where(), "a " + name + " joint needs 'axis'");
    j.axis = p.vec3("axis").normalized();
  } else if (p.has("axis")) {
    throw Error(Exit::scene, p.at("axis").where(), "axis has no meaning: a " + name + " joint has none");
  }
  read_coordinate(p, j);
  return j;
}

// The joints as a forest: from what supports hold, and where nothing is held from the body that the first joint is tied to, every body follows the
// one before it. Joints that close a loop come on top.
class Forest {
 public:
  Forest(const model::Model& model, const std::vector<Joint>& joints)
      : model_(model), joints_(joints), ground_(static_cast<Index>(model.bodies.size())), edges_(ground_ + 1), reached_(ground_ + 1, 0) {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const Index a = node(joints_[i].body), b = node(joints_[i].to);
      if (a == b) refuse(joints_[i]);
      if (joined(a, b)) {
        closing_.push_back(static_cast<Index>(i));
        continue;
      }
      edges_[a].push_back({static_cast<Index>(i), b});
      edges_[b].push_back({static_cast<Index>(i), a});
    }
  }

  // visit(joint, the body that follows)
  template <class Visit>
  void walk(Visit visit) {
    from(ground_, visit);
    for (const Joint& j : joints_) from(node(j.to), visit);
  }
  const std::vector<Index>& closing() const { return closing_; }

 private:
  struct Edge {
    Index joint, to;
  };
  bool held(Index body) const { return body == model::Tie::kWorld || model_.held[model_.bodies[body].block_begin] == 2; }
  Index node(Index body) const { return held(body) ? ground_ : body; }  // all that supports hold is one

  template <class Visit>
  void from(Index root, Visit& visit) {
    if (reached_[root]) return;
    reached_[root] = 1;
    for (std::deque<Index> todo{root}; !todo.empty(); todo.pop_front())
      for (const Edge& e : edges_[todo.front()]) {
        if (reached_[e.to]) continue;
        reached_[e.to] = 1;
        visit(joints_[e.joint], e.to);
        todo.push_back(e.to);
      }
  }

  // By joints so far.
  bool joined(Index a, Index b) const {
    std::vector<std::uint8_t> seen(edges_.size(), 0);
    seen[a] = 1;
    for (std::deque<Index> todo{a}; !todo.empty() && !seen[b]; todo.pop_front())
      for (const Edge& e : edges_[todo.front()])
        if (!seen[e.to]) seen[e.to] = 1, todo.push_back(e.to);
    return seen[b];
  }

  [[noreturn]] void refuse(const Joint& j) const {
    const auto called = [&](Index body) {
      return body == model::Tie::kWorld ? std::string("the world") : "'" + model_.bodies[body].name + "', which is pinned";
    };
    throw Error(Exit::scene, j.entry->where(),
                "joins " + called(j.body) + ", and " + called(j.to) + ": supports hold both already, and no joint can move them");
  }

  const model::Model& model_;
  const std::vector<Joint>& joints_;
  const Index ground_;
  std::vector<std::vector<Edge>> edges_;  // by body
  std::vector<Index> closing_;            // joints between bodies that others join already
  std::vector<std::uint8_t> reached_;
};

// A joint that mimics. Where that is linear in blocks it is a tie: slides side by side, and hinges side by side that turn alike. Otherwise it is an
// equation of its coordinate (equations.h).
void mimic(const model::Model& model, const Joint& j, Read& all) {
  const Params& p = j.entry->at("mimic");
  const std::string mine = tie_of("joint", *j.entry, j.body, j.to).name;
  const auto named = [&](const std::string& name) {
    return std::find_if(all.joints.begin(), all.joints.end(),
                        [&](const model::Joint& o) { return o.name == name && o.env == model.bodies[j.body].env; });
  };
  const auto me = named(mine), leader = named(p.text("joint"));
  const auto refuse = [&](const std::string& why) {
    throw Error(Exit::scene, p.at("joint").where(), "'" + mine + "' cannot mimic '" + p.text("joint") + "': " + why);
  };
  if (leader == all.joints.end()) {
    std::string known;
    for (const model::Joint& o : all.joints)
      if (o.env == me->env && o.has_coordinate() && o.name != mine) known += (known.empty() ? "" : ", ") + ("'" + o.name + "'");
    refuse("there is no such joint" + (known.empty() ? "" : "; there are: " + known));
  }
  if (!leader->has_coordinate()) refuse("that one is neither revolute nor prismatic");
  const auto number = [&](const auto& joint) { return static_cast<Index>(joint - all.joints.begin()); };
  std::size_t round = 0;
  for (Index at = number(leader); at >= 0 && round <= all.joints.size(); at = all.joints[at].leader, ++round)
    if (at == number(me)) refuse(leader == me ? "that is the same joint" : "that one follows it");
  me->leader = number(leader), me->ratio = p.number("ratio");
  if (leader->type != me->type || leader->to != me->to || leader->axis.cross(me->axis).norm() > tuning::kParallel || me->follower != me->body) return;
  const double ratio = me->ratio * (leader->axis.dot(me->axis) > 0 ? 1 : -1);
  model::Tie& tie = all.ties[me->tie];
  if (me->type == Type::prismatic && leader->follower == leader->body) {
    tie.follows.push_back(mimics(model, me->body, leader->body, me->to, ratio));
    me->mimics = true;
  } else if (me->type == Type::revolute && ratio == 1 && !tie.follows.empty()) {
    tie.follows = turns_as(model, std::move(tie.follows), me->body, leader->body);
    me->mimics = true;
  }
}

}  // namespace

Read read(const Params& list, const model::Model& model) {
  std::vector<Joint> joints;
  on_each(list.items(), [&](const Params& p) {
    for (const auto& [body, to] : tied_bodies(model, p)) joints.push_back(read_entry(p, model, body, to));
  });
  Read out;
  const auto add = [&](const Joint& j, model::Tie tie, Index follower) {
    model::Joint view;
    view.name = tie.name, view.where = tie.where, view.type = j.type;
    view.env = model.bodies[j.body].env, view.body = j.body, view.to = j.to;
    view.place = j.at, view.axis = j.axis;
    view.tie = static_cast<Index>(out.ties.size());
    view.follower = follower;
    view.at_rest = view.value = j.stands;
    view.low = j.low, view.high = j.high;
    out.joints.push_back(std::move(view));
    out.ties.push_back(std::move(tie));
    out.stop_effort.push_back(j.entry->has("stop_effort") ? j.entry->number("stop_effort") : 0);
  };
  Forest forest(model, joints);
  forest.walk([&](const Joint& j, Index child) {
    model::Tie tie = tie_of("joint", *j.entry, j.body, j.to);
    const Index parent = child == j.body ? j.to : j.body;
    tie.follows = joint::follows(model, j.type, child, parent, j.at, j.axis);
    tie.anchor = material_point(model, parent, j.at);
    add(j, std::move(tie), child);
  });
  for (Index i : forest.closing()) {
    const Joint& j = joints[i];
    if (j.type == Type::prismatic)
      throw Error(Exit::scene, j.entry->where(), "a prismatic joint cannot close a loop of joints: list it before the others of the loop");
    model::Tie tie = tie_of("joint", *j.entry, j.body, j.to);
    tie.closes = joint::follows(model, j.type, j.body, j.to, j.at, j.axis);
    tie.anchor = material_point(model, j.to, j.at);
    add(j, std::move(tie), j.body);
  }
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].entry->has("mimic")) mimic(model, joints[i], out);
  return out;
}

}  // namespace mortise::effects::joint
