#include "solver/kernels.h"

namespace mortise::solver {

void largest(View<const Vec3> v, const std::vector<Index>& env_blocks, EnvValues out) {
  device::env_max("solver.largest", env_blocks, [=] MORTISE_HD(Index b) { return v[b].norm(); }, out);
}

std::vector<double> largest(View<const Vec3> v, const std::vector<Index>& env_blocks) {
  std::vector<double> out(env_blocks.size() - 1, 0.0);
  Fetch fetch;
  largest(v, env_blocks, {out, fetch});
  fetch.now();
  return out;
}

void dot(View<const Vec3> a, View<const Vec3> b, const std::vector<Index>& env_blocks, EnvValues out) {
  device::env_sum("solver.dot", env_blocks, [=] MORTISE_HD(Index i) { return a[i].dot(b[i]); }, out);
}

std::vector<double> dot(View<const Vec3> a, View<const Vec3> b, const std::vector<Index>& env_blocks) {
  std::vector<double> out(env_blocks.size() - 1, 0.0);
  Fetch fetch;
  dot(a, b, env_blocks, {out, fetch});
  fetch.now();
  return out;
}

void support_move(View<const Vec3> q, View<const Vec3> target, View<const Mat3> projector, Buffer<Vec3>& c) {
  c.resize(q.n);
  const View<Vec3> out = c.view();
  device::parallel_for("solver.support_move", q.n, [=] MORTISE_HD(Index b) {
    const Vec3 gap = target[b] - q[b];
    out[b] = gap - projector[b] * gap;
  });
}

void stencil_product(linalg::StencilSet& set, View<const Vec3> d) {
  const linalg::StencilView v = set.view();
  device::parallel_for("solver.stencil_product", v.n, [=] MORTISE_HD(Index s) {
    const Index first = v.offset[s], nb = v.offset[s + 1] - first;
    for (Index a = 0; a < nb; ++a) v.grad[first + a] = Vec3::Zero();
    for (Index a = 0; a < nb; ++a) {
      const Index ia = v.block[first + a];
      if (ia < 0) continue;
      for (Index b = a; b < nb; ++b) {
        const Index ib = v.block[first + b];
        if (ib < 0) continue;
        const Mat3& H = v.hess[v.hess_offset[s] + linalg::pair_place(a, b, nb)];
        v.grad[first + a] += H * d[ib];
        if (a != b) v.grad[first + b] += H.transpose() * d[ia];
      }
    }
  });
}

void right_hand_side(View<const Vec3> g, View<const Vec3> Hc, View<const Index> block_of_row, View<const Mat3> row_projector, Buffer<Vec3>& rhs) {
  rhs.resize(block_of_row.n);
  const View<Vec3> out = rhs.view();
  device::parallel_for("solver.rhs", block_of_row.n, [=] MORTISE_HD(Index r) {
    const Index b = block_of_row[r];
    Vec3 f = -g[b];
    if (Hc.n > 0) f -= Hc[b];
    out[r] = row_projector[r] * f;
  });
}

void difference(View<const Vec3> a, View<const Vec3> b, const std::vector<double>& scale, View<const Index> block_of_row, View<const Index> block_env, View<Vec3> out) {
  const Buffer<double> scales(scale);
  const View<const double> s = scales.view();
  device::parallel_for("solver.difference", out.n, [=] MORTISE_HD(Index r) { out[r] = s[block_env[block_of_row[r]]] * (a[r] - b[r]); });
}

void step_of(View<const Vec3> x, View<const Vec3> c, View<const Index> row_of_block, View<const Mat3> projector, Buffer<Vec3>& dq) {
  dq.resize(row_of_block.n);
  const View<Vec3> out = dq.view();
  device::parallel_for("solver.step_of", row_of_block.n, [=] MORTISE_HD(Index b) {
    Vec3 d = c[b];
    if (row_of_block[b] >= 0) d += projector[b] * x[row_of_block[b]];
    out[b] = d;
  });
}

void advance(View<const Vec3> q, View<const Vec3> dq, const std::vector<double>& alpha, const model::Model& model, Buffer<Vec3>& trial) {
  trial.resize(q.n);
  const Buffer<double> alpha_buffer(alpha);
  const View<const double> a = alpha_buffer.view();
  const View<const Index> env = model.block_env.view();
  const View<const Mat3> P = model.projector.view();
  const View<const Vec3> target = model.target.view();
  const View<Vec3> out = trial.view();
  device::parallel_for("solver.advance", q.n, [=] MORTISE_HD(Index b) {
    const double s = a[env[b]];
    Vec3 y = q[b] + s * dq[b];
    if (s == 1) {
      const Vec3 gap = target[b] - y;
      y += gap - P[b] * gap;
      if (P[b].isZero(0)) y = target[b];
    }
    out[b] = y;
  });
}

void add(View<const Vec3> from, Buffer<Vec3>& to) {
  const View<Vec3> t = to.view();
  device::parallel_for("solver.add", from.n, [=] MORTISE_HD(Index b) { t[b] += from[b]; });
}

double largest_of(const std::vector<double>& v) { return v.empty() ? 0 : *std::max_element(v.begin(), v.end()); }

void subtract(View<const Vec3> a, View<const Vec3> b, Buffer<Vec3>& out) {
  out.resize(a.n);
  const View<Vec3> to = out.view();
  device::parallel_for("solver.subtract", a.n, [=] MORTISE_HD(Index i) { to[i] = a[i] - b[i]; });
}

void add_scaled(View<const Vec3> v, const std::vector<double>& share, View<const Index> block_env, Buffer<Vec3>& to) {
  const Buffer<double> shares(share);
  const View<const double> s = shares.view();
  const View<Vec3> t = to.view();
  device::parallel_for("solver.add_scaled", v.n, [=] MORTISE_HD(Index b) { t[b] += s[block_env[b]] * v[b]; });
}

void largest_force(View<const Vec3> g, View<const Mat3> projector, View<const double> lever, const std::vector<Index>& body_blocks, EnvValues out) {
  device::env_max("solver.largest_force", body_blocks, [=] MORTISE_HD(Index b) { return (projector[b] * g[b]).norm() / lever[b]; }, out);
}

void sum_of_sizes(View<const Vec3> g, View<const double> position, const std::vector<Index>& body_blocks, EnvValues out) {
  device::env_sum("solver.sum_of_sizes", body_blocks, [=] MORTISE_HD(Index b) { return position[b] * g[b].norm(); }, out);
}

void net_force(View<const Vec3> g, View<const double> position, int axis, const std::vector<Index>& body_blocks, EnvValues out) {
  device::env_sum("solver.net_force", body_blocks, [=] MORTISE_HD(Index b) { return position[b] * g[b][axis]; }, out);
}

void farthest(View<const Vec3> a, View<const Vec3> b, View<const double> lever, const std::vector<Index>& body_blocks, EnvValues out) {
  device::env_max("solver.farthest", body_blocks, [=] MORTISE_HD(Index i) { return lever[i] * (a[i] - b[i]).norm(); }, out);
}

void rounding_floor(const linalg::BlockMatrix& A, View<const Vec3> q, View<const Index> block_of_row, View<const double> lever, const std::vector<Index>& body_rows, EnvValues largest, EnvValues sum) {
  constexpr double kEps = 2.220446049250313e-16;
  const View<const Index> start = A.row_start.view();
  const View<const Mat3> value = A.value.view();
  const auto floor = [=] MORTISE_HD(Index r) {
    const Index b = block_of_row[r];
    return 8 * kEps * value[start[r]].norm() * q[b].norm() / lever[b];
  };
  device::env_max("solver.rounding", body_rows, floor, largest);
  device::env_sum("solver.rounding_sum", body_rows, floor, sum);
}

void shift_diagonal(linalg::BlockMatrix& A, double share) {
  const View<const Index> start = std::as_const(A.row_start).view();
  const View<Mat3> value = A.value.view();
  const double trace = device::sum("solver.trace", A.rows, [=] MORTISE_HD(Index r) { return value[start[r]].trace(); });
  const double shift = share * trace / (3.0 * A.rows);
  device::parallel_for("solver.shift_diagonal", A.rows, [=] MORTISE_HD(Index r) { value[start[r]] += shift * Mat3::Identity(); });
}

}  // namespace mortise::solver
