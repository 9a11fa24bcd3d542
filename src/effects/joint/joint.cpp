#include "effects/joint/joint.h"

#include <algorithm>
#include <deque>

namespace mortise::effects {
namespace {

using joint::Type;
using param::of;
using param::optional;

const ParamTable kTable = tie_table(
    "joint", "Joints between stiff bodies, or to the world, without stiffness or tolerance.",
    {param::required(param::choice("type", {"fixed", "spherical", "revolute"}, "", "fixed: nothing moves; spherical: a ball joint; revolute: a hinge.")),
     of(Param::Kind::text, "body", Unit::none, std::nullopt, "Name of a stiff body."),
     optional(of(Param::Kind::text, "to", Unit::none, std::nullopt, "Name of the stiff body that it is joined to; without it the world.")),
     optional(of(Param::Kind::vec3, "at", Unit::length, std::nullopt, "Where the joint is, world coordinates at rest; a fixed one needs none.")),
     optional(of(Param::Kind::vec3, "axis", Unit::none, std::nullopt, "Axis of a revolute joint, world coordinates at rest."))});

// One entry of the scene in one environment.
struct Joint {
  const Params* entry;
  Type type;
  Index body, to;
  Vec3 at, axis = Vec3::Zero();
};

Joint read(const Params& p, const model::Model& model, Index body, Index to) {
  if (model.bodies[body].type != model::BodyType::stiff) throw Error(Exit::scene, p.at("body").where(), "'" + p.text("body") + "' is soft; joints are between stiff bodies (a bond ties soft ones)");
  const std::string& name = p.text("type");
  Joint j{&p, name == "fixed" ? Type::fixed : name == "spherical" ? Type::spherical : Type::revolute, body, to, model.bodies[body].centre};
  if (p.has("at"))
    j.at = p.vec3("at");
  else if (j.type != Type::fixed)
    throw Error(Exit::scene, p.where(), "a " + name + " joint needs 'at', where it is");
  if (j.type == Type::revolute) {
    if (!p.has("axis")) throw Error(Exit::scene, p.where(), "a revolute joint needs 'axis'");
    j.axis = p.vec3("axis").normalized();
  } else if (p.has("axis")) {
    throw Error(Exit::scene, p.at("axis").where(), "axis has no meaning: a " + name + " joint has none");
  }
  return j;
}

// The joints as a forest: from what supports hold, and where nothing is held from the body that the first joint is tied to, every body follows the
// one before it. Joints that close a loop come on top.
class Forest {
 public:
  Forest(const model::Model& model, const std::vector<Joint>& joints) : model_(model), joints_(joints), ground_(static_cast<Index>(model.bodies.size())), edges_(ground_ + 1), reached_(ground_ + 1, 0) {
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
    const auto called = [&](Index body) { return body == model::Tie::kWorld ? std::string("the world") : "'" + model_.bodies[body].name + "', which is pinned"; };
    throw Error(Exit::scene, j.entry->where(), "joins " + called(j.body) + ", and " + called(j.to) + ": supports hold both already, and no joint can move them");
  }

  const model::Model& model_;
  const std::vector<Joint>& joints_;
  const Index ground_;
  std::vector<std::vector<Edge>> edges_;  // by body
  std::vector<Index> closing_;            // joints between bodies that others join already
  std::vector<std::uint8_t> reached_;
};

std::vector<model::Tie> ties(const Params& list, const model::Model& model) {
  std::vector<Joint> joints;
  for (const Params& p : list.items())
    for (const auto& [body, to] : tied_bodies(model, p)) joints.push_back(read(p, model, body, to));
  std::vector<model::Tie> out;
  Forest forest(model, joints);
  forest.walk([&](const Joint& j, Index child) {
    model::Tie tie = tie_of("joint", *j.entry, j.body, j.to);
    const Index parent = child == j.body ? j.to : j.body;
    tie.follows = joint::follows(model, j.type, child, parent, j.at, j.axis);
    tie.anchor = material_point(model, parent, j.at);
    out.push_back(std::move(tie));
  });
  for (Index i : forest.closing()) {
    const Joint& j = joints[i];
    model::Tie tie = tie_of("joint", *j.entry, j.body, j.to);
    tie.closes = joint::follows(model, j.type, j.body, j.to, j.at, j.axis);
    tie.anchor = material_point(model, j.to, j.at);
    out.push_back(std::move(tie));
  }
  return out;
}

}  // namespace

const Kind& joint_kind() {
  static const Kind kind{"joint", Role::tie, "stiff bodies hang together by joints", &kTable,
          [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<TieEffect>("joint", m, ties(p, m)); },
          {"Chen, Diaz, Lan, Yang, Kaufman, Sifakis: A Unified Newton Barrier Method for Multibody Dynamics. ACM TOG 41(4), 2022"}};
  return kind;
}

}  // namespace mortise::effects
