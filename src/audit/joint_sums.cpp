#include "audit/joint_sums.h"

#include <cmath>
#include <utility>

#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

namespace {

// About the centre of mass c: 2 T of velocities w x (x - c) is w . I w.
Mat3 inertia_about_centre(const model::BodyInput& input) {
  if (input.type == model::BodyType::soft) return Mat3::Zero();
  const MeasuredBody body(input, 0);
  std::vector<double> points, velocity(3 * input.nodes.size());
  for (const Vec3& x : input.nodes) points.insert(points.end(), {x[0], x[1], x[2]});
  const auto twice = [&](const Vec3& w) {
    for (std::size_t i = 0; i < input.nodes.size(); ++i) Eigen::Map<Vec3>(velocity.data() + 3 * i) = w.cross(input.nodes[i]);
    return 2 * body.turning_energy(velocity, points);
  };
  Mat3 out;
  for (int i = 0; i < 3; ++i) out(i, i) = twice(Vec3::Unit(i));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j) out(i, j) = out(j, i) = 0.5 * (twice(Vec3::Unit(i) + Vec3::Unit(j)) - out(i, i) - out(j, j));
  return out;
}

}  // namespace

std::vector<std::string> kinematic_joints(const Params& effects, const Holds& holds) {
  std::vector<std::string> out;
  for (const Params& p : entries(effects, "drive"))
    if (const std::optional<Params> joint = joint_named(effects, p.text("joint"));
        joint && !joint->has("mimic") && holds.motor_of(p.text("joint")).kinematic)
      out.push_back(p.text("joint"));
  return out;
}

double driving(const Snapshot& said, const std::string& joint, const JointSums::Sums& sums, std::size_t j, double h) {
  const std::string torque = "drive/" + joint + "_torque", force = "drive/" + joint + "_force";
  const bool turns = said.has(torque);
  return std::fmax(std::abs(said.at(turns ? torque : force)), tuning::kNoWay * (turns ? 1 : sums.size[j]) / (h * h) * sums.M(j, j));
}

JointSums::JointSums(const model::ModelInput& input, const Holds& holds, std::vector<std::string> joints,
                     const std::function<bool(const std::string&)>& counts)
    : holds_(holds), joints_(std::move(joints)) {
  if (joints_.empty()) return;
  std::size_t number = 0;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    if (counts(b.name)) carried_.push_back({number, inertia_about_centre(b)});
    rest_[b.name] = b.nodes, ++number;
  }
}

JointSums::Sums JointSums::of(const std::vector<double>& points, const std::vector<MovingBody>& bodies) const {
  const std::size_t n = joints_.size();
  Sums out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), std::vector<bool>(n), std::vector<bool>(n), std::vector<double>(n)};
  std::map<std::string, std::size_t> first;
  for (const MovingBody& b : bodies) first[b.body.name] = b.body.first;
  std::map<std::string, geometry::Motion> found;  // many hang on the same
  const auto motion = [&](const std::string& body) {
    if (const auto known = found.find(body); known != found.end()) return known->second;
    const std::vector<Vec3>& rest = rest_.at(body);
    std::vector<Vec3> now;
    for (std::size_t i = 0; i < rest.size(); ++i) now.push_back(at(points, first.at(body) + i));
    return found[body] = geometry::nearest_motion_of_any(rest, now);
  };
  for (const Carried& c : carried_) {
    const MovingBody& b = bodies[c.number];
    const Mat3 R = b.body.soft() ? Mat3::Identity() : motion(b.body.name).R, I = R * c.inertia * R.transpose();
    const double m = b.body.mass();
    const auto by = holds_.moved_by(b.body.name, motion, b.x);
    for (std::size_t j = 0; j < n; ++j) {
      const auto phi = by.find(joints_[j]);
      if (phi == by.end()) continue;
      out.J[j] += m * phi->second.v.dot(b.a) + phi->second.w.dot(I * b.alpha);
      for (std::size_t k = 0; k < n; ++k)
        if (const auto other = by.find(joints_[k]); other != by.end())
          out.M(j, k) += m * phi->second.v.dot(other->second.v) + phi->second.w.dot(I * other->second.w);
      out.touches[j] = out.touches[j] || b.touches, out.stopped[j] = out.stopped[j] || b.stopped;
      if (out.size[j] == 0) out.size[j] = b.body.radius(b.x, points);
    }
  }
  return out;
}

}  // namespace mortise::audit
