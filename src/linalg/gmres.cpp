#include "linalg/gmres.h"

#include <cmath>
#include <utility>

#include "linalg/env_sums.h"

namespace mortise::linalg {
namespace {

// Scalars of one environment's Krylov space: R of the QR factorisation of the Hessenberg matrix, column by column, the rotations
// that made it, and the rotated right-hand side.
struct Small {
  std::vector<std::vector<double>> R;
  std::vector<double> c, s, g;

  // Adds the column h[0..j], h[j+1] = below; returns the residual's size.
  double add(std::vector<double> h, double below) {
    for (std::size_t i = 0; i < c.size(); ++i) {
      const double up = c[i] * h[i] + s[i] * h[i + 1];
      h[i + 1] = -s[i] * h[i] + c[i] * h[i + 1];
      h[i] = up;
    }
    const double last = h.back(), r = std::hypot(last, below);
    c.push_back(r > 0 ? last / r : 1);
    s.push_back(r > 0 ? below / r : 0);
    h.back() = r;
    R.push_back(std::move(h));
    const double old = g.back();
    g.back() = c.back() * old;
    g.push_back(-s.back() * old);
    return std::abs(g.back());
  }

  std::vector<double> solve() const {
    std::vector<double> y(R.size(), 0.0);
    for (std::size_t i = R.size(); i-- > 0;) {
      double sum = g[i];
      for (std::size_t j = i + 1; j < R.size(); ++j) sum -= R[j][i] * y[j];
      y[i] = R[i][i] > 0 ? sum / R[i][i] : 0;
    }
    return y;
  }
};

Buffer<Index> environments_of_rows(const std::vector<Index>& env_rows) {
  Buffer<Index> out(env_rows.back());
  if (env_rows.size() == 2) {
    out.zero();
    return out;
  }
  const Buffer<Index> offsets(env_rows);
  const View<const Index> first = offsets.view();
  const View<Index> env = out.view();
  device::parallel_for("gmres.env", env.n, [=] MORTISE_HD(Index i) {
    Index lo = 0, hi = first.n - 1;  // the last environment that begins at or before i
    while (hi - lo > 1) {
      const Index mid = (lo + hi) / 2;
      (first[mid] <= i ? lo : hi) = mid;
    }
    env[i] = lo;
  });
  return out;
}

std::vector<double> dot(View<const Vec3> a, View<const Vec3> b, const device::Ranges& rows) {
  std::vector<double> out(rows.environments(), 0.0);
  device::env_sum(
      "gmres.dot", rows, [=] MORTISE_HD(Index i) { return a[i].dot(b[i]); }, out);
  return out;
}

// Products of the newest vector w with the basis, and of itself, per environment: the host is told once all of them are known.
class Column {
 public:
  Column(const std::vector<Index>& env_rows, View<const Index> env, Index most)
      : sums_(env_rows), env_(env), envs_(static_cast<Index>(env_rows.size()) - 1), h_((most + 1) * envs_) {}

  // Of the environments of `whose` from now on.
  void begin(const std::vector<std::uint8_t>& whose) {
    if (envs_ > 1) active_.upload(whose);
    size_ = 0;
  }
  // The next entry is v . w; w <- w - (v . w) v.
  void take_out(View<const Vec3> v, const device::Ranges& rows, View<Vec3> w) {
    const View<const double> h = add(v, w);
    const View<const Index> env = env_;
    device::parallel_for("gmres.take_out", rows, [=] MORTISE_HD(Index i) {
      const double s = -h[env[i]];
      w[i] = w[i] + s * v[i];
    });
  }
  // The last one is w . w.
  void end(View<const Vec3> w, device::Fetch& fetch) {
    add(w, w);
    fetch.add(View<const double>{h_.view().p, size_ * envs_}, fetched_);
  }
  // All of them, by environment, once that is fetched.
  std::vector<std::vector<double>> entries() const {
    std::vector<std::vector<double>> of_env(envs_);
    for (std::size_t i = 0; i < fetched_.size(); ++i) of_env[i % of_env.size()].push_back(fetched_[i]);
    return of_env;
  }
  // The next entry, a . b.
  View<const double> add(View<const Vec3> a, View<const Vec3> b) {
    const View<const Index> env = env_;
    const View<const std::uint8_t> active = std::as_const(active_).view();
    const View<double> out{h_.view().p + size_++ * envs_, envs_};
    const auto products = [=] MORTISE_HD(Index i) -> Vec2 {
      if (active.n > 0 && !active[env[i]]) return Vec2::Zero();
      return Vec2(a[i].dot(b[i]), 0);
    };
    sums_("gmres.dot", products, [=] MORTISE_HD(Index e, const Vec2& sum) { out[e] = sum[0]; });
    return out;
  }

 private:
  EnvSums sums_;
  View<const Index> env_;
  Index envs_, size_ = 0;
  Buffer<double> h_;  // entry after entry
  std::vector<double> fetched_;
  Buffer<std::uint8_t> active_;
};

// y_e <- share_e x_e, or y_e + share_e x_e
void combine(bool keep, const std::vector<double>& scale, View<const Vec3> x, View<const Index> env, const device::Ranges& rows, View<Vec3> y) {
  const Buffer<double> buffer(scale);
  const View<const double> s = buffer.view();
  device::parallel_for("gmres.combine", rows, [=] MORTISE_HD(Index i) { y[i] = keep ? Vec3(y[i] + s[env[i]] * x[i]) : Vec3(s[env[i]] * x[i]); });
}

// y = x / |x|, of a single environment.
void normalise(View<const Vec3> x, View<const double> square, View<Vec3> y) {
  device::parallel_for("gmres.combine", x.n, [=] MORTISE_HD(Index i) {
    const double size = std::sqrt(square[0]);
    y[i] = (size > 0 ? 1 / size : 0.0) * x[i];
  });
}

}  // namespace

Awaited awaited(Operator op) {
  return [op = std::move(op)](View<const Vec3> in, View<Vec3> out, const std::function<void(device::Fetch&)>& then) {
    op(in, out);
    device::Fetch fetch;
    then(fetch);
    fetch.now("preconditioned product");
  };
}

GmresResult gmres(const Operator& A, const Awaited& preconditioner, View<const Vec3> b, View<Vec3> x, const std::vector<Index>& env_rows,
                  const std::vector<double>& relative, Index limit, const std::function<void(const std::vector<std::uint8_t>&)>& go_on,
                  const std::vector<double>& b2) {
  const std::size_t envs = env_rows.size() - 1;
  const Index n = b.n;
  const Buffer<Index> env_buffer = environments_of_rows(env_rows);
  const View<const Index> env = env_buffer.view();

  GmresResult out;
  out.relative.assign(envs, 0.0);
  out.of_env.assign(envs, 0);
  std::vector<std::uint8_t> active(envs, 0);
  std::vector<Small> small(envs);
  std::vector<double> square, size(envs), scale(envs);  // square: |b|^2
  const auto invert = [&](std::size_t e, double v) { scale[e] = v > 0 ? 1 / v : 0; };
  bool any = false;
  const auto begin = [&] {  // with the sizes of b
    any = false;
    for (std::size_t e = 0; e < envs; ++e) {
      size[e] = std::sqrt(square[e]);
      small[e].g = {size[e]};
      invert(e, size[e]);
      active[e] = size[e] > 0;
      any |= size[e] > 0;
    }
  };
  std::vector<Buffer<Vec3>> v, z;
  v.emplace_back(n);
  Buffer<Vec3> w(n);
  w.zero();
  Column products(env_rows, env, limit + 1);
  const bool later = b2.empty() && envs == 1;  // when there is a product the host hears of its size
  Buffer<double> own_size(later ? 1 : 0);
  if (later) {
    products.begin(active);
    device::copy(own_size.view().p, products.add(b, b).p, sizeof(double));
    normalise(b, std::as_const(own_size).view(), v[0].view());
    active[0] = 1, any = true;
  } else {
    square = b2.empty() ? dot(b, b, env_rows) : b2;
    begin();
    combine(false, scale, b, env, env_rows, v[0].view());
  }
  while (any && out.iterations < limit) {
    const device::Ranges rows(env_rows, active);
    if (go_on) go_on(active);
    z.emplace_back(n);
    preconditioner(std::as_const(v.back()).view(), z.back().view(), [&](device::Fetch& fetch) {
      A(std::as_const(z.back()).view(), w.view());
      products.begin(active);
      for (const Buffer<Vec3>& basis : v) products.take_out(basis.view(), rows, w.view());  // modified Gram-Schmidt
      products.end(std::as_const(w).view(), fetch);
      if (square.empty()) fetch.add(std::as_const(own_size).view(), square);
    });
    if (later && out.iterations == 0) begin();
    if (!any) break;
    ++out.iterations;
    std::vector<std::vector<double>> column = products.entries();
    any = false;
    for (std::size_t e = 0; e < envs; ++e) {
      scale[e] = 0;
      if (!active[e]) continue;
      const double length = std::sqrt(column[e].back());
      column[e].pop_back();
      const double residual = small[e].add(std::move(column[e]), length);
      out.relative[e] = size[e] > 0 ? residual / size[e] : 0;
      out.of_env[e] = out.iterations;
      active[e] = out.relative[e] > relative[e];
      if (active[e]) invert(e, length);
      any |= active[e] != 0;
    }
    v.emplace_back(n);
    v.back().zero();
    combine(false, scale, std::as_const(w).view(), env, rows, v.back().view());
  }
  device::clear(x.p, n * sizeof(Vec3));
  std::vector<std::vector<double>> y(envs);
  for (std::size_t e = 0; e < envs; ++e) y[e] = small[e].solve();
  for (std::size_t j = 0; j < z.size(); ++j) {
    for (std::size_t e = 0; e < envs; ++e) scale[e] = j < y[e].size() ? y[e][j] : 0;
    combine(true, scale, std::as_const(z[j]).view(), env, env_rows, x);
  }
  return out;
}

}  // namespace mortise::linalg
