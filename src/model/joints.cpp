#include "model/joints.h"

#include <cmath>
#include <set>

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

std::vector<Follow> placed_at(const Model& model, const Joint& joint, Index child, double value) {
  const bool body_follows = child == joint.body;
  const Index parent = body_follows ? joint.to : joint.body;
  const double angle = (body_follows ? 1 : -1) * (value - joint.at_rest), half = std::sin(0.5 * angle);
  const Vec3& u = joint.axis;
  Mat3 K;
  K << 0, -u[2], u[1], u[2], 0, -u[0], -u[1], u[0], 0;
  const Mat3 R = Mat3::Identity() + std::sin(angle) * K + 2 * half * half * (K * K);  // Rodrigues
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
  const Vec3 from = parent == Tie::kWorld ? Vec3(Vec3::Zero()) : model.bodies[parent].centre;
  std::vector<Follow> out{follow(c.block_begin, joint.place - from - R * (joint.place - c.centre), false)};
  for (int k = 0; k < 3; ++k) out.push_back(follow(c.block_begin + 1 + k, R.col(k), true));
  return out;
}

Follow axis_of(const Model& model, const Joint& joint) {
  if (joint.to == Tie::kWorld) return {-1, {}, joint.axis};
  const Index first = model.bodies[joint.to].block_begin + 1;
  return {-1, {{first, joint.axis[0]}, {first + 1, joint.axis[1]}, {first + 2, joint.axis[2]}}};
}

}  // namespace mortise::model
