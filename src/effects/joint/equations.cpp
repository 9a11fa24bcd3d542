#include "effects/joint/equations.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "effects/joint/tuning.h"
#include "effects/joint/usual.h"
#include "effects/per_environment.h"
#include "linalg/small.h"

namespace mortise::effects::joint {

namespace {

Index carrier_of_slide(const model::Joint& j) { return j.follower == j.body ? j.to : j.body; }

}  // namespace

Equations::One Equations::described(Index joint) const {
  const model::Joint& j = model_.joints[joint];
  const Usual usual = joint::usual(model_, j);
  One o;
  o.joint = joint, o.env = j.env;
  const bool slides = j.type == model::JointType::prismatic;
  o.inertia = usual.mass * (slides ? 1 : usual.lever * usual.lever), o.effort = usual.weight() * (slides ? 1 : usual.lever);
  o.scale = slides ? usual.lever : 1;
  return o;
}

void Equations::find() {
  list_.clear();
  std::vector<Index> env;
  for (Index e = 0; e < model_.envs; ++e)
    for (std::size_t i = 0; i < model_.joints.size(); ++i) {
      const model::Joint& j = model_.joints[i];
      if (j.env != e || j.mimics || model_.ties.list()[j.tie].driven()) continue;
      const auto joint = static_cast<Index>(i);
      if (j.leader >= 0) {
        One o = described(joint);
        o.leader = j.leader;
        o.now.two = true, o.now.ratio = j.ratio, o.now.offset = j.at_rest - j.ratio * model_.joints[j.leader].at_rest;
        list_.push_back(o), env.push_back(e);
      }
      if (j.type != model::JointType::prismatic || model::guided_by_support(model_, j)) continue;
      for (int side = 0; side < 2; ++side) {
        One o = described(joint);
        const Vec3 first = linalg::any_perpendicular(j.axis);
        o.across = side == 0 ? first : Vec3(j.axis.cross(first));
        list_.push_back(o), env.push_back(e);
      }
    }
  env_offset_ = env_offsets(env, model_.envs);
  for (One& o : list_) place(o);
  upload();
}

void Equations::place(One& o) const {
  const model::Joint& j = model_.joints[o.joint];
  o.now.x = model::coordinate_of(model_, j);
  if (o.leader >= 0) {
    o.now.y = model::coordinate_of(model_, model_.joints[o.leader]);
  } else {
    o.now.x.u = o.across, o.now.x.at_rest = o.now.x.before = 0;
    o.now.y = o.now.x;
  }
}

void Equations::upload() {
  std::vector<Equation> all;
  for (const One& o : list_) all.push_back(o.now);
  on_device_.upload(all);
}

void Equations::begin_step(const StepInfo& step) {
  for (One& o : list_) {
    if (!step.taken_by(o.env)) continue;
    place(o);
    o.K = step.is_static ? tuning::kOfEffort * o.effort / o.scale : tuning::kOfInertia * o.inertia / (step.dt * step.dt);
    o.now.lambda = o.lambda, o.now.K = o.K, o.before = INFINITY;
  }
  upload();
}

void Equations::energy(Positions q, device::EnvValues per_env) const {
  const View<const Equation> list = on_device_.view();
  device::env_sum(
      "joint.equations_energy", env_offset_, [=] MORTISE_HD(Index i) { return joint::energy(list[i], joint::reading(list[i], q)); }, per_env);
}

void Equations::fill(Positions q, Want want, EquationLinearisation& at, Index first_block, Index first_pair) const {
  at.equations.resize(size());
  const View<const Equation> list = on_device_.view();
  const View<EquationReading> there = at.equations.view();
  const bool forces = want.forces;
  const Curvature curvature = want.matrix;
  const View<const Index> env = std::as_const(model_.block_env).view();
  const linalg::StencilView out = at.stencils.view();
  device::parallel_for("joint.equations", list.n, [=] MORTISE_HD(Index i) {
    const Equation e = list[i];
    const EquationReading r = joint::reading(e, q);
    there[i] = r;
    if (!forces) return;
    const double concavity = curvature.wanted ? curvature.concavity(env[e.x.any_block()]) : 0;
    const Index first = first_block + kEquationBlocks * i;
    equation_stencil(e, r, concavity, out.block.p + first, out.grad.p + first,
                     curvature.wanted ? out.hess.p + first_pair + linalg::pair_count(kEquationBlocks) * i : nullptr);
  });
}

void Equations::max_step(View<const Vec3> dq, const EquationLinearisation& at, device::EnvValues alpha) const {
  const View<const Equation> list = on_device_.view();
  const View<const EquationReading> there = at.equations.view();
  device::env_min(
      "joint.equations_max_step", env_offset_, [=] MORTISE_HD(Index i) { return equation_way(list[i], there[i], joint::reading(list[i], dq, true)); },
      alpha);
}

std::vector<double> Equations::misses(Positions q) const {
  device::Buffer<double> value(size());
  const View<double> out = value.view();
  const View<const Equation> list = on_device_.view();
  device::parallel_for("joint.equations_miss", list.n, [=] MORTISE_HD(Index i) { out[i] = miss(list[i], joint::reading(list[i], q)); });
  return value.download();
}

void Equations::refit(Positions q, std::vector<Effect::Refit>& per_env) {
  const std::vector<double> c = misses(q);
  bool changed = false;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    One& o = list_[i];
    const double size = std::abs(c[i]);
    if (!(size > tuning::kMiss * o.scale)) continue;
    o.now.lambda += o.now.K * c[i];
    if (size > tuning::kFalls * o.before) o.now.K *= tuning::kStiffer;
    o.before = size;
    per_env[o.env] = std::max(per_env[o.env], Effect::Refit::from_here);
    changed = true;
  }
  if (changed) upload();
}

void Equations::object(Positions q, std::vector<std::string>& per_env) const {
  const std::vector<double> c = misses(q);
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const One& o = list_[i];
    if (!(std::abs(c[i]) > tuning::kMostMiss * o.scale)) continue;
    const model::Joint& j = model_.joints[o.joint];
    std::ostringstream why;
    why.precision(2);
    if (o.leader >= 0)
      why << "the joint '" << j.name << "' misses by " << c[i] << " " << j.unit() << " what it should follow of '" << model_.joints[o.leader].name
          << "': something holds both";
    else
      why << "the joint '" << j.name << "' is " << c[i] << " m beside its axis: something holds both of its bodies";
    per_env[o.env] = why.str();
  }
}

void Equations::end_step(const StepInfo& step, Positions q) {
  const std::vector<double> c = misses(q);
  for (std::size_t i = 0; i < list_.size(); ++i) {
    One& o = list_[i];
    if (!step.taken_by(o.env)) continue;
    o.lambda = o.now.lambda, o.K = o.now.K, o.miss = c[i];
  }
}

void Equations::report(const FieldSinks& sinks) const {
  const std::vector<Vec3> q = model_.q.download();
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const One& o = list_[i];
    const model::Joint& j = model_.joints[o.joint];
    const double force = -(o.lambda + o.K * o.miss);
    if (o.leader >= 0) {
      sinks[o.env].scalar("joint", j.name + "_coupling", j.effort_unit(), force);
      continue;
    }
    // Both directions of a slide, one after the other: on `body`.
    const One& other = list_[i + 1];
    const Index carrier = carrier_of_slide(j);
    Vec3 sum = Vec3::Zero();
    for (const One* one : {&o, &other})
      for (int k = 0; k < 3; ++k) {
        const Vec3 axis = carrier == model::Tie::kWorld ? Vec3(Vec3::Unit(k)) : q[model_.bodies[carrier].block_begin + 1 + k];
        sum -= (one->lambda + one->K * one->miss) * one->across[k] * axis;
      }
    if (j.follower != j.body) sum = -sum;
    for (int k = 0; k < 3; ++k) sinks[o.env].scalar("joint", j.name + "_guide_" + "xyz"[k], "N", sum[k]);
    sinks[o.env].scalar("joint", j.name + "_beside", "m", std::hypot(o.miss, other.miss));
    ++i;
  }
}

void Equations::checkpoint(Archive& archive) {
  if (!any()) return;
  std::vector<double> state;
  std::vector<Index> env;
  for (const One& o : list_) state.insert(state.end(), {o.lambda, o.K, o.miss}), env.push_back(o.env);
  archive.io("equations", state, firsts(env, model_.envs, 3));
  if (!archive.loading()) return;
  if (state.size() != 3 * list_.size())
    throw Error(Exit::file, "the checkpoint belongs to another scene: joints in it have " + std::to_string(state.size() / 3) + " equations");
  for (std::size_t i = 0; i < list_.size(); ++i) {
    One& o = list_[i];
    o.lambda = o.now.lambda = state[3 * i], o.K = o.now.K = state[3 * i + 1], o.miss = state[3 * i + 2];
    place(o);
  }
  upload();
}

}  // namespace mortise::effects::joint
