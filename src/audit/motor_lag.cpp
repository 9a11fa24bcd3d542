#include "audit/motor_lag.h"

#include <algorithm>

#include "audit/archived.h"
#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "effects/tie_name.h"

namespace mortise::audit {

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
  std::vector<std::string> joints;
  for (const Motor& m : motors_) joints.push_back(m.joint);
  sums_.emplace(input, holds_, joints, [&](const std::string& body) { return holds_.goes_by_gains(body); });
}

// theta through the step that led to a state.
void MotorLag::advance(const JointSums::Sums& sums, const std::vector<How>& how, const Snapshot& said) {
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
    if (how[j] == How::as_a_mechanism) continue;
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
      if (how[j] == How::as_a_mechanism && !m.saturated(said)) Error::see(e.as_should, m.torque_at(target, theta[j], rate[j]));
    }
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const Motor& m = motors_[j];
    Error& e = errors_[j];
    const bool followed = how[j] == How::as_a_mechanism;
    e.theta = followed ? theta[j] : x[j], e.rate = followed ? rate[j] : v[j];
    e.swing.state(x[j], v[j], m.wanted(said), (sums.J[j] + m.armature * a[j]) / sums.M(j, j), a[j], integration_.step);
    if (how[j] != How::as_a_swing || m.saturated(said)) e.swing.beside.rest();
    if (const double beside = e.swing.beside.e; beside != 0) {
      e.reach = std::max(e.reach, std::abs(x[j] + beside - e.start));
      Error::see(e.as_should, m.torque_at(m.wanted(said), x[j] + beside, v[j]));
    }
  }
}

void MotorLag::Swing::state(double to, double rate, double wanted, double driven_to, double a_to, double h) {
  const double now = (to - x) / h, target_now = (wanted - target) / h;
  if (++states > 2) {
    beside.fit(h * (now - target_now), rate - v - (target_now - target_slope), driven_to - driven);
    beside.swing(a, a_to, now - slope, h);
  }
  x = to, slope = now, v = rate, target = wanted, target_slope = target_now, driven = driven_to, a = a_to;
}

void MotorLag::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (!sums_ || sums_->empty() || bodies.empty()) return;
  errors_.resize(motors_.size());
  JointSums::Sums sums = sums_->of(points, bodies);
  // BDF2 begins with shorter steps of first order, whose accelerations nobody reports.
  const bool begins = ++states_ <= tuning::kBegins && integration_.second_order;
  std::vector<How> how;
  for (std::size_t j = 0; j < motors_.size(); ++j) {
    const Motor& m = motors_[j];
    sums.M(j, j) += m.armature;
    how.push_back(begins || sums.stopped[j] ? How::not_at_all : m.has_gains() && !sums.touches[j] ? How::as_a_mechanism : How::as_a_swing);
    if (errors_[j].size == 0) errors_[j].size = m.slides ? sums.size[j] : 1;
  }
  if (states_ > 1) advance(sums, how, said);
  for (std::size_t j = 0; j < motors_.size(); ++j) {
    const Motor& m = motors_[j];
    Error& e = errors_[j];
    const double x = said.at(m.coordinate), v = said.at(m.rate), torque = m.torque_of(said);
    if (states_ == 1) e.start = e.theta = x, e.rate = e.v = v;
    e.target = m.wanted(said);
    e.wrong = std::max(e.wrong, std::abs(x - e.theta)), e.far = std::max(e.far, std::abs(x - e.start));
    Error::see(e.torque, torque);
    if (states_ == 1 || (how[j] != How::as_a_mechanism && e.swing.beside.e == 0) || m.saturated(said)) Error::see(e.as_should, torque);
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
