#pragma once
// Derivative checks shared by all effects. Fourth-order central differences: with a step h of about 1e-3 of the length on which
// the function varies, truncation (h^4) and round-off (eps / h) are both far below the wanted 1e-6 and 1e-5.
#include <Eigen/Dense>
#include <algorithm>
#include <utility>
#include <vector>

#include "effects/effect.h"
#include "linalg/stencils.h"
#include "model/model.h"

namespace mortise::fd {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// Values: what two derivatives disagree by, as a fraction of the largest entry of the analytic one (or of `floor`).
inline double relative_error(const Matrix& analytic, const Matrix& numeric, double floor = 0) {
  if (analytic.size() == 0) return 0;
  const double scale = std::max({analytic.cwiseAbs().maxCoeff(), floor, 1e-300});
  const double error = (analytic - numeric).cwiseAbs().maxCoeff() / scale;
  return error == error ? error : 1e300;  // a NaN fails every bound
}

// d f / d x of a scalar function f(x), step h.
template <class F>
Vector difference_gradient(F f, Vector x, double h) {
  Vector g(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double x0 = x[i];
    auto at = [&](double s) {
      x[i] = x0 + s;
      return f(x);
    };
    g[i] = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    x[i] = x0;
  }
  return g;
}

// d g / d x of a vector function g(x), one column per entry of x.
template <class G>
Matrix difference_jacobian(G g, Vector x, double h) {
  Matrix J;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double x0 = x[i];
    auto at = [&](double s) -> Vector {
      x[i] = x0 + s;
      return g(x);
    };
    const Vector column = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    if (J.size() == 0) J.resize(column.size(), x.size());
    J.col(i) = column;
    x[i] = x0;
  }
  return J;
}

// ---- whole effects, on whichever device the test is built for ------------------------------------------------------------

inline Vector flatten(const std::vector<Vec3>& q) {
  Vector x(3 * static_cast<Eigen::Index>(q.size()));
  for (std::size_t i = 0; i < q.size(); ++i) x.segment<3>(3 * i) = q[i];
  return x;
}
inline std::vector<Vec3> blocks_of(const Vector& x) {
  std::vector<Vec3> q(x.size() / 3);
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = x.segment<3>(3 * i);
  return q;
}

template <class T>
std::vector<std::remove_const_t<T>> fetch(device::View<T> v) {
  std::vector<std::remove_const_t<T>> host(v.n);
  if (v.n) device::copy_out(host.data(), v.p, v.n * sizeof(T));
  return host;
}

// An effect with the linearisation that a test looks at, connected when it is first used: when all effects exist.
struct Subject {
  model::Model& model;
  std::unique_ptr<effects::Effect> effect;
  std::unique_ptr<effects::Linearisation> at;

  Subject(model::Model& m, std::unique_ptr<effects::Effect> e) : model(m), effect(std::move(e)) {}
  effects::Linearisation& here() {
    if (at) return *at;
    effect->connect();
    at = effect->linearisation();
    at->contact.env_offset.assign(model.envs + 1, 0);
    return *at;
  }
  // With the samples of q, frozen there.
  void freeze(device::View<const Vec3> q) {
    effect->linearise(q, effects::Want::frozen(), here());
    effect->sample(here());
  }
  linalg::StencilSet& linearise(device::View<const Vec3> q, effects::Curvature matrix) {
    effect->linearise(q, {true, matrix}, here());
    return here().stencils;
  }
  void begin_step(effects::StepInfo info) {
    here();
    effect->integrate(info);
    effect->begin_step(info);
    freeze(std::as_const(model.q).view());
  }
  void end_step(device::View<const Vec3> q) {
    freeze(q);
    effect->end_step({}, q, here());
  }
  void adapt(double budget) { effect->adapt({}, std::vector<double>(model.envs, budget), here()); }
  void report(FieldSink& sink) {
    if (!at) freeze(std::as_const(model.q).view());
    effect->report(sink, here());
  }
  void checkpoint(Archive& archive) {
    here();
    effect->checkpoint(archive);
  }
  double energy_now() { return effect->energy_now(std::as_const(model.q).view(), here(), model.envs); }
  std::vector<model::ContactSample> samples() {
    effect->sample(here());
    return here().contact.samples.download();
  }
};

// The energies of all environments at x, with what the subject's linearisation has frozen.
inline std::vector<double> effect_energies(Subject& e, const Vector& x, Index envs = 1) {
  const device::Buffer<Vec3> q(blocks_of(x));
  std::vector<double> per_env(envs, 0.0);
  device::Fetch fetch;
  e.effect->energy(q.view(), e.here(), {per_env, fetch});
  fetch.now();
  return per_env;
}
// The longest allowed step of the one environment, from where the subject was linearised, which is readied for energies on that way.
inline double longest_step(Subject& e, device::View<const Vec3> dq) {
  std::vector<double> alpha{1};
  device::Fetch fetch;
  e.effect->max_step(dq, e.here(), {alpha, fetch});
  fetch.now();
  e.effect->reach(e.here());
  return alpha[0];
}
inline double effect_energy(Subject& e, const Vector& x, Index envs = 1) {
  double sum = 0;
  for (double v : effect_energies(e, x, envs)) sum += v;
  return sum;
}

// The stencils of an effect added up to a dense gradient and Hessian.
struct Dense {
  Vector gradient;
  Matrix hessian;  // empty unless asked for
};
inline Dense dense(linalg::StencilSet& set, Eigen::Index size, bool hessian) {
  const linalg::StencilView s = set.view();
  Dense d;
  d.gradient = Vector::Zero(size);
  if (hessian) d.hessian = Matrix::Zero(size, size);
  if (s.n == 0) return d;
  const auto offset = fetch(s.offset), hess_offset = fetch(s.hess_offset), block = fetch(s.block);
  const auto grad = fetch(s.grad);
  const auto hess = fetch(s.hess);
  for (Index k = 0; k < s.n; ++k) {
    const Index begin = offset[k], nb = offset[k + 1] - begin;
    for (Index a = 0; a < nb; ++a) {
      const Index i = block[begin + a];
      if (i < 0) continue;
      d.gradient.segment<3>(3 * i) += grad[begin + a];
      for (Index b = a; hessian && b < nb; ++b) {
        const Index j = block[begin + b];
        if (j < 0) continue;
        const Mat3& h = hess[hess_offset[k] + linalg::pair_place(a, b, nb)];
        d.hessian.block<3, 3>(3 * i, 3 * j) += h;
        if (a != b) d.hessian.block<3, 3>(3 * j, 3 * i) += h.transpose();
      }
    }
  }
  return d;
}
inline Dense effect_assemble(Subject& e, const Vector& x, effects::Curvature hessian) {
  const device::Buffer<Vec3> q(blocks_of(x));
  return dense(e.linearise(q.view(), hessian), x.size(), hessian.wanted);
}

struct Errors {
  double gradient = 0;  // energy -> gradient: wanted below 1e-6
  double hessian = 0;   // gradient -> Hessian: wanted below 1e-5
};
inline Errors effect_errors(Subject& e, const Vector& x, double h, Index envs = 1) {
  const Dense d = effect_assemble(e, x, effects::Curvature(true, 1));
  const Vector g = difference_gradient([&](const Vector& y) { return effect_energy(e, y, envs); }, x, h);
  const Matrix H = difference_jacobian([&](const Vector& y) { return effect_assemble(e, y, false).gradient; }, x, h);
  return {relative_error(d.gradient, g), relative_error(d.hessian, H)};
}

// Lowest eigenvalue of a symmetric matrix over its largest in magnitude: at least -1e-12 for what an effect assembles.
inline double lowest_eigenvalue(const Matrix& H) {
  const Vector l = Eigen::SelfAdjointEigenSolver<Matrix>(H).eigenvalues();
  return l.minCoeff() / std::max(l.cwiseAbs().maxCoeff(), 1e-300);
}

}  // namespace mortise::fd
