#include "run/idle_joints.h"

#include <Eigen/Dense>
#include <map>

#include "base/disjoint_sets.h"
#include "effects/tie_name.h"
#include "geometry/bounds.h"

namespace mortise::run {
namespace {

using Scalars = Eigen::Matrix<double, 4, 1>;
constexpr double kNew = 1e-6;  // of a condition: what of it others do not say

// c: from the middle of all bodies, in their size.
std::vector<Scalars> conditions(const Params& joint, const Vec3& c) {
  const std::string& type = joint.text("type");
  std::vector<Scalars> out;
  const auto add = [&](double place, const Vec3& direction) { out.emplace_back(place, direction[0], direction[1], direction[2]); };
  if (type != "prismatic") add(1, c);
  if (type == "revolute") add(0, joint.vec3("axis").normalized());
  for (int k = 0; (type == "fixed" || type == "prismatic") && k < 3; ++k) add(0, Vec3::Unit(k));
  return out;
}

// What is held so far: an orthonormal basis of conditions.
class Held {
 public:
  // Is it new?
  bool add(Eigen::VectorXd row) {
    const double size = row.norm();
    for (int pass = 0; pass < 2; ++pass)
      for (const Eigen::VectorXd& known : rows_) row -= known.dot(row) * known;
    if (!(row.norm() > kNew * size)) return false;
    rows_.push_back(row.normalized());
    return true;
  }

 private:
  std::vector<Eigen::VectorXd> rows_;
};

}  // namespace

std::vector<std::string> idle_joints(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  const Params* joints = effects.find("joint");
  if (!joints || joints->items().size() < 2) return {};
  std::map<std::string, Eigen::Index> number;  // of stiff bodies that nothing holds, from 1; else 0, as the world
  geometry::Bounds all;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type != model::BodyType::stiff) continue;
    number.emplace(body.name, static_cast<Eigen::Index>(number.size()) + 1);
    for (const Vec3& x : body.nodes) all.include(x);
  }
  const Params* pins = effects.find("pin");
  for (std::size_t i = 0; pins && i < pins->items().size(); ++i)
    if (const auto held = number.find(pins->items()[i].text("body")); held != number.end()) held->second = 0;
  const auto body_of = [&](const Params& joint, const char* key) {
    const auto found = joint.has(key) ? number.find(joint.text(key)) : number.end();
    return found == number.end() ? 0 : found->second;
  };

  Held held;
  const auto adds = [&](const Params& joint) {
    const Vec3 c = joint.has("at") ? Vec3((joint.vec3("at") - 0.5 * (all.lo + all.hi)) / all.size().norm()) : Vec3::Zero();
    bool any = joint.text("type") == "prismatic";  // what it holds across its axis is no tie
    for (const Scalars& of : conditions(joint, c)) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(4 * static_cast<Eigen::Index>(number.size()));
      for (const auto& [body, sign] : {std::pair{body_of(joint, "body"), 1.0}, std::pair{body_of(joint, "to"), -1.0}})
        if (body > 0) row.segment<4>(4 * (body - 1)) += sign * of;
      any = held.add(row) || any;
    }
    return any;
  };

  std::vector<const Params*> closing;
  DisjointSets hang(number.size() + 1);
  for (const Params& joint : joints->items()) {
    const auto a = static_cast<std::size_t>(body_of(joint, "body")), b = static_cast<std::size_t>(body_of(joint, "to"));
    if (hang.of(a) == hang.of(b)) {
      closing.push_back(&joint);
      continue;
    }
    hang.join(a, b);
    adds(joint);
  }
  std::vector<std::string> out;
  for (const Params* joint : closing)
    if (!adds(*joint))
      out.push_back(
          (joint->where().file.empty() ? "" : joint->where().text() + ": ") + "joint '" + effects::tie_name(*joint) +
          "' holds nothing that other joints do not hold already: they bear all, and it is told to bear nothing, as stiff bodies do not say "
          "how joints share a load");
  return out;
}

}  // namespace mortise::run
