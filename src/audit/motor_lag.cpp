#include "audit/motor_lag.h"

#include <algorithm>

#include "audit/archived.h"
#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "effects/tie_name.h"

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

MotorLag::MotorLag(const model::ModelInput& input) : integration_(integration_of(input.scene)), holds_(input.scene.at("effects")) {
  const Params& effects = input.scene.at("effects");
  if (std::isnan(integration_.step)) return;
  for (const Params& p : entries(effects, "drive")) {
    const std::string& name = p.text("joint");
    const Holds::Motor& motor = holds_.motor_of(name);
    const std::optional<Params> joint = joint_named(effects, name);
    if (!motor.swings() || !joint || joint->has("mimic")) continue;
    const bool slides = joint->text("type") == "prismatic";
    motors_.push_back({motor, name, "joint/" + name + (slides ? "_travel" : "_angle"), "joint/" + name + "_rate",
                       "drive/" + name + (slides ? "_force" : "_torque"), "drive/" + name + "_target", slides, p.has("rest") ? p.number("rest") : 0});
  }
  if (motors_.empty()) return;
  std::size_t number = 0;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    if (holds_.goes_by_gains(b.name)) carried_.push_back({number, inertia_about_centre(b)});
    rest_[b.name] = b.nodes, ++number;
  }
}

MotorLag::Sums MotorLag::sum(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  const std::size_t n = motors_.size();
  Sums out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), std::vector<bool>(n, true), std::vector<bool>(n, false)};
  for (std::size_t j = 0; j < n; ++j) out.M(j, j) = motors_[j].armature;
  std::map<std::string, std::size_t> number;
  for (const MovingBody& b : bodies) number[b.body.name] = b.body.first;
  std::map<std::string, geometry::Motion> found;  // many hang on the same
  const auto motion = [&](const std::string& body) {
    if (const auto known = found.find(body); known != found.end()) return known->second;
    const std::vector<Vec3>& rest = rest_.at(body);
    std::vector<Vec3> now;
    for (std::size_t i = 0; i < rest.size(); ++i) now.push_back(at(points, number.at(body) + i));
    return found[body] = geometry::nearest_motion_of_any(rest, now);
  };
  for (const Carried& c : carried_) {
    const MovingBody& b = bodies[c.number];
    const Mat3 R = b.body.soft() ? Mat3::Identity() : motion(b.body.name).R, I = R * c.inertia * R.transpose();
    const double m = b.body.mass();
    const auto by = holds_.moved_by(b.body.name, motion, b.x);
    for (std::size_t j = 0; j < n; ++j) {
      const auto phi = by.find(motors_[j].joint);
      if (phi == by.end()) continue;
      out.J[j] += m * phi->second.v.dot(b.a) + phi->second.w.dot(I * b.alpha);
      for (std::size_t k = 0; k < n; ++k)
        if (const auto other = by.find(motors_[k].joint); other != by.end())
          out.M(j, k) += m * phi->second.v.dot(other->second.v) + phi->second.w.dot(I * other->second.w);
      if (b.touches || b.stopped) out.free[j] = false;
      if (b.stopped) out.stopped[j] = true;
      if (errors_[j].size == 0) errors_[j].size = motors_[j].slides ? b.body.radius(b.x, points) : 1;
    }
  }
  return out;
}

// theta through the step that led to a state.
void MotorLag::advance(const Sums& sums, const Snapshot& said) {
  const auto n = static_cast<Eigen::Index>(motors_.size());
  Eigen::VectorXd x(n), v(n), a(n), changed(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Motor& m = motors_[j];
    const Error& e = errors_[j];
    x[j] = said.at(m.coordinate), v[j] = said.at(m.rate), a[j] = integration_.rate_of(v[j], e.v, e.v_before, states_ - 1);
    changed[j] = a[j] - e.a;
  }
  Eigen::MatrixXd M = sums.M;
  Eigen::VectorXd K(n), D(n), g(n), dg(n), theta(n), rate(n);
  const Eigen::VectorXd own = M * a, of_own = M * changed;
  for (Eigen::Index j = 0; j < n; ++j) {
    const Motor& m = motors_[j];
    Error& e = errors_[j];
    const bool gives_all = m.saturated(said);
    K[j] = m.spring + (gives_all ? 0 : m.kp), D[j] = m.damping + (gives_all ? 0 : m.kd);
    // Nothing is late that begins with the run, and what begins with it does so at once.
    const bool begins = states_ == 2;
    const double late = !begins && !integration_.second_order ? sums.J[j] + m.armature * a[j] - e.J - of_own[j] : 0,
                 now = own[j] + D[j] * v[j] + K[j] * x[j] + late;
    g[j] = begins ? now : e.g, dg[j] = now - g[j], theta[j] = e.theta, rate[j] = e.rate;
    e.g = now, e.J = sums.J[j] + m.armature * a[j], e.a = a[j], e.v_before = e.v, e.v = v[j];
    if (sums.free[j]) continue;
    M.row(j).setZero(), M.col(j).setZero();
    M(j, j) = 1, K[j] = D[j] = g[j] = dg[j] = 0;
  }
  const double k = integration_.step / tuning::kMotorParts;
  Eigen::MatrixXd A = M;
  A.diagonal() += k * D + k * k * K;
  const Eigen::LDLT<Eigen::MatrixXd> factor(A);
  for (int part = 1; part <= tuning::kMotorParts; ++part) {
    const double share = part / static_cast<double>(tuning::kMotorParts);
    const Eigen::VectorXd load = g + share * dg;
    rate += k * factor.solve(Eigen::VectorXd(load - D.cwiseProduct(rate) - K.cwiseProduct(theta + k * rate)));
    theta += k * rate;
    for (Eigen::Index j = 0; j < n; ++j) {
      const Motor& m = motors_[j];
      Error& e = errors_[j];
      const double target = e.target + share * (m.wanted(said) - e.target);
      if (sums.free[j] && !m.saturated(said)) Error::see(e.as_should, m.torque_at(target, theta[j], rate[j]));
    }
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const Motor& m = motors_[j];
    Error& e = errors_[j];
    e.theta = sums.free[j] ? theta[j] : x[j], e.rate = sums.free[j] ? rate[j] : v[j];
    e.touched.state(x[j], v[j], m.wanted(said), (sums.J[j] + m.armature * a[j]) / sums.M(j, j), a[j], integration_.step);
    if (sums.free[j] || sums.stopped[j] || m.saturated(said)) e.touched.swing.rest();
    if (const double beside = e.touched.swing.e; beside != 0) {
      e.reach = std::max(e.reach, std::abs(x[j] + beside - e.start));
      Error::see(e.as_should, m.torque_at(m.wanted(said), x[j] + beside, v[j]));
    }
  }
}

void MotorLag::TouchedJoint::state(double to, double rate, double wanted, double driven_to, double a_to, double h) {
  const double now = (to - x) / h, target_now = (wanted - target) / h;
  if (++states > 2) {
    swing.fit(h * (now - target_now), rate - v - (target_now - target_slope), driven_to - driven);
    swing.swing(a, a_to, now - slope, h);
  }
  x = to, slope = now, v = rate, target = wanted, target_slope = target_now, driven = driven_to, a = a_to;
}

void MotorLag::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (carried_.empty() || bodies.empty()) return;
  errors_.resize(motors_.size());
  Sums sums = sum(points, bodies);
  // BDF2 begins with shorter steps of first order, whose accelerations nobody reports.
  if (++states_ <= tuning::kBegins && integration_.second_order) sums.free.assign(sums.free.size(), false);
  if (states_ > 1) advance(sums, said);
  for (std::size_t j = 0; j < motors_.size(); ++j) {
    const Motor& m = motors_[j];
    Error& e = errors_[j];
    const double x = said.at(m.coordinate), v = said.at(m.rate), torque = m.torque_of(said);
    if (states_ == 1) e.start = e.theta = x, e.rate = e.v = v;
    e.target = m.wanted(said);
    e.wrong = std::max(e.wrong, std::abs(x - e.theta)), e.far = std::max(e.far, std::abs(x - e.start));
    Error::see(e.torque, torque);
    if (states_ == 1 || (!sums.free[j] && e.touched.swing.e == 0) || m.saturated(said)) Error::see(e.as_should, torque);
  }
}

double MotorLag::way() const {
  double most = NAN;
  for (const Error& e : errors_) {
    const double missing = std::max(e.reach - e.far, 0.0);
    most =
        std::fmax(most, std::max(e.wrong / std::max(e.far, tuning::kStill * 2 * e.size), missing / std::max(e.reach, tuning::kStill * 2 * e.size)));
  }
  return most;
}

double MotorLag::torque() const {
  double largest[2] = {0, 0}, most = NAN;  // of hinges, of slides
  for (std::size_t j = 0; j < errors_.size(); ++j) largest[motors_[j].slides] = std::max(largest[motors_[j].slides], errors_[j].should());
  for (std::size_t j = 0; j < errors_.size(); ++j) {
    const Error& e = errors_[j];
    const double least =
        std::max({tuning::kOtherWay * e.should(), tuning::kFaint * largest[motors_[j].slides], tuning::kRoundedWay * motors_[j].kp * e.size});
    if (least > 0)
      for (const int way : {0, 1}) most = std::fmax(most, std::abs(e.torque[way] - e.as_should[way]) / std::max(e.as_should[way], least));
  }
  return most;
}

void MotorLag::checkpoint(Archive& archive) {
  archive_all(archive, "motor_lag.errors", errors_);
  archive.io("motor_lag.states", states_);
}

}  // namespace mortise::audit
