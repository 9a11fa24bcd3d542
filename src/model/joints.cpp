#include "model/joints.h"

#include <set>

#include "base/rotation.h"
#include "model/model.h"

namespace mortise::model {

std::vector<Index> joints_named(const Model& model, const std::string& name, const SourceLoc& cited) {
  std::vector<Index> out;
  std::set<std::string> known;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    known.insert("'" + model.joints[j].name + "'");
    if (model.joints[j].name == name) out.push_back(static_cast<Index>(j));
  }
  if (!out.empty()) return out;
  std::string all;
  for (const std::string& other : known) all += (all.empty() ? "" : ", ") + other;
  throw Error(Exit::scene, cited, "no joint is called '" + name + "'" + (all.empty() ? ": the scene has no joint" : "; there are: " + all));
}

namespace {

Index carrier_of(const Joint& joint) { return joint.follower == joint.body ? joint.to : joint.body; }
double side_of(const Joint& joint) { return joint.follower == joint.body ? 1 : -1; }
Vec3 centre_of(const Model& model, Index body) { return body == Tie::kWorld ? Vec3(Vec3::Zero()) : model.bodies[body].centre; }

}  // namespace

Coordinate coordinate_of(const Model& model, const Joint& joint) {
  Coordinate c;
  c.at_rest = joint.at_rest, c.before = joint.value;
  const auto first = [&](Index body) { return body == Tie::kWorld ? -1 : model.bodies[body].block_begin; };
  if (joint.type == JointType::prismatic) {
    const Index carrier = carrier_of(joint);
    c.slides = true;
    c.slider = first(joint.follower), c.carrier = first(carrier);
    c.u = side_of(joint) * joint.axis, c.X = centre_of(model, joint.follower) - centre_of(model, carrier);
    c.carried_freely = carrier != Tie::kWorld && !model.bodies[carrier].prescribed();
  } else {
    c.hinge = hinge_about(joint.axis, first(joint.body) + 1, joint.to == Tie::kWorld ? -1 : first(joint.to) + 1);
    c.slider = -1, c.u = c.X = Vec3::Zero();
  }
  return c;
}

std::vector<Follow> placed_at(const Model& model, const Joint& joint, double value) {
  const Index child = joint.follower, parent = carrier_of(joint);
  const double change = side_of(joint) * (value - joint.at_rest);
  const bool slides = joint.type == JointType::prismatic;
  const Mat3 R = slides ? Mat3(Mat3::Identity()) : rotation(joint.axis, change);
  const Body& c = model.bodies[child];
  // p_t + A_t d, or only the direction A_t d
  const auto follow = [&](Index block, const Vec3& d, bool direction) {
    Follow f{block, {}};
    if (parent == Tie::kWorld) {
      f.fixed = d;
      return f;
    }
    const Index first = model.bodies[parent].block_begin;
    if (!direction) f.terms.push_back({first, 1});
    for (int k = 0; k < 3; ++k) f.terms.push_back({first + 1 + k, d[k]});
    return f;
  };
  const Vec3 from = centre_of(model, parent);
  std::vector<Follow> out{
      follow(c.block_begin, slides ? Vec3(c.centre - from + change * joint.axis) : Vec3(joint.place - from - R * (joint.place - c.centre)), false)};
  for (int k = 0; k < 3; ++k) out.push_back(follow(c.block_begin + 1 + k, R.col(k), true));
  return out;
}

Follow axis_of(const Model& model, const Joint& joint) {
  if (joint.to == Tie::kWorld) return {-1, {}, joint.axis};
  const Index first = model.bodies[joint.to].block_begin + 1;
  return {-1, {{first, joint.axis[0]}, {first + 1, joint.axis[1]}, {first + 2, joint.axis[2]}}};
}

bool guided_by_support(const Model& model, const Joint& joint) {
  const Index carrier = carrier_of(joint);
  return (carrier == Tie::kWorld || model.bodies[carrier].prescribed()) && !model.ties.tied(model.bodies[joint.follower].block_begin);
}

std::vector<Guided> guided(const Model& model) {
  std::vector<Guided> out;
  for (Index i = 0; i < static_cast<Index>(model.joints.size()); ++i) {
    const Joint& j = model.joints[i];
    if (j.type == JointType::prismatic && !j.mimics && guided_by_support(model, j)) out.push_back({i, j.follower, carrier_of(j)});
  }
  return out;
}

void guide(Model& model) {
  std::vector<Vec3> target;
  std::vector<Mat3> projector;
  for (const auto& [joint, body, carrier] : guided(model)) {
    const Joint& j = model.joints[joint];
    const Index slider = model.bodies[body].block_begin;
    if (target.empty()) target = model.target.download(), projector = model.projector.download();
    // Blocks of what is prescribed, at the end of the step.
    const auto at_end = [&](Index block) {
      if (!model.ties.tied(block)) return target[block];
      Vec3 sum = model.ties.fixed(block);
      for (const TieTerm& t : model.ties.terms(block)) sum += t.weight * target[t.block];
      return sum;
    };
    const Vec3 u = side_of(j) * j.axis, X = centre_of(model, j.follower) - centre_of(model, carrier);
    Vec3 on = X, along = u;
    if (carrier != Tie::kWorld) {
      const Index first = model.bodies[carrier].block_begin;
      on = at_end(first), along = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        const Vec3 a = at_end(first + 1 + k);
        on += X[k] * a, along += u[k] * a;
      }
      along.normalize();
    }
    projector[slider] = along * along.transpose();
    target[slider] = on;
    model.held[slider] = 1;
  }
  if (target.empty()) return;
  model.target.upload(target);
  model.projector.upload(projector);
}

}  // namespace mortise::model
