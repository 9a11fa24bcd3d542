#include "solver/kernels.h"

#include <algorithm>

namespace mortise::solver {

void largest(View<const Vec3> v, const std::vector<Index>& env_blocks, EnvValues out) {
  device::env_max(
      "solver.largest", env_blocks, [=] MORTISE_HD(Index b) { return v[b].norm(); }, out);
}

std::vector<double> largest(View<const Vec3> v, const std::vector<Index>& env_blocks) {
  std::vector<double> out(env_blocks.size() - 1, 0.0);
  Fetch fetch;
  largest(v, env_blocks, {out, fetch});
  fetch.now("largest");
  return out;
}

void dot(View<const Vec3> a, View<const Vec3> b, const std::vector<Index>& env_blocks, EnvValues out) {
  device::env_sum(
      "solver.dot", env_blocks, [=] MORTISE_HD(Index i) { return a[i].dot(b[i]); }, out);
}

std::vector<double> dot(View<const Vec3> a, View<const Vec3> b, const std::vector<Index>& env_blocks) {
  std::vector<double> out(env_blocks.size() - 1, 0.0);
  Fetch fetch;
  dot(a, b, env_blocks, {out, fetch});
  fetch.now("dot");
  return out;
}

void support_move(View<const Vec3> q, View<const Vec3> target, View<const Mat3> projector, Buffer<Vec3>& c) {
  c.resize(q.n);
  const View<Vec3> out = c.view();
  device::parallel_for("solver.support_move", q.n, [=] MORTISE_HD(Index b) {
    const Vec3 gap = target[b] - q[b], left = gap - projector[b] * gap;
    // Across a line that is not an axis rounding leaves something for ever.
    constexpr double kRounding = 1e-15;
    const bool there = left.norm() <= kRounding * (q[b].norm() + target[b].norm()) && !projector[b].isZero(0);
    out[b] = there ? Vec3(Vec3::Zero()) : left;
  });
}

void stencil_product(linalg::StencilSet& set, const model::Model& model, View<const Vec3> d) {
  const linalg::StencilView v = set.view();
  const Buffer<std::uint8_t> at_work(model.at_work);
  const View<const std::uint8_t> works = at_work.view();
  const View<const Index> env = model.block_env.view();
  device::parallel_for("solver.stencil_product", v.n, [=] MORTISE_HD(Index s) {
    const Index first = v.offset[s], nb = v.offset[s + 1] - first;
    if (works.n > 0 && nb > 0 && v.block[first] >= 0 && !works[env[v.block[first]]]) return;
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

void add_to_rows(View<const Vec3> g, const device::Ranges& whose, View<const Index> block_of_row, View<const Mat3> row_projector, View<Vec3> out) {
  device::parallel_for("solver.add_to_rows", whose, [=] MORTISE_HD(Index r) { out[r] += row_projector[r] * g[block_of_row[r]]; });
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

void step_of(View<const Vec3> x, View<const Vec3> c, View<const Index> row_of_block, View<const Mat3> projector, Buffer<Vec3>& dq) {
  dq.resize(row_of_block.n);
  const View<Vec3> out = dq.view();
  device::parallel_for("solver.step_of", row_of_block.n, [=] MORTISE_HD(Index b) {
    Vec3 d = c.n > 0 ? c[b] : Vec3(Vec3::Zero());
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
  if (model.ties.driven())
    model.ties.place_after(q, a, env, out);
  else if (model.ties.any())
    model.ties.place(out);
}

void add(View<const Vec3> from, Buffer<Vec3>& to) { add(from, device::Ranges{0, from.n}, to); }

void add(View<const Vec3> from, const device::Ranges& where, Buffer<Vec3>& to) {
  const View<Vec3> t = to.view();
  device::parallel_for("solver.add", where, [=] MORTISE_HD(Index b) { t[b] += from[b]; });
}

double largest_of(const std::vector<double>& v) { return v.empty() ? 0 : *std::max_element(v.begin(), v.end()); }

void subtract(View<const Vec3> a, View<const Vec3> b, Buffer<Vec3>& out) {
  out.resize(a.n);
  const View<Vec3> to = out.view();
  device::parallel_for("solver.subtract", a.n, [=] MORTISE_HD(Index i) { to[i] = a[i] - b[i]; });
}

void add_scaled(View<const Vec3> v, const std::vector<double>& scale, View<const Index> block_env, Buffer<Vec3>& to) {
  const Buffer<double> scales(scale);
  const View<const double> s = scales.view();
  const View<Vec3> t = to.view();
  device::parallel_for("solver.add_scaled", v.n, [=] MORTISE_HD(Index b) { t[b] += s[block_env[b]] * v[b]; });
}

void force_sizes(const Chunks& blocks, View<const Vec3> g, View<const Mat3> projector, View<const double> lever, View<const double> position,
                 Fetch& fetch, ReceiveParts receive) {
  blocks.reduce(
      "solver.force_sizes",
      [=] MORTISE_HD(Index b) {
        Part p{};
        p.largest = (projector[b] * g[b]).norm() / lever[b];
        p.sum[0] = position[b] * g[b].norm();
        return p;
      },
      fetch, receive);
}

void residual_sizes(const Chunks& blocks, View<const Vec3> g, View<const Mat3> projector, View<const double> lever, View<const double> position,
                    View<const Vec3> q, View<const Vec3> q0, Fetch& fetch, ReceiveParts receive) {
  blocks.reduce(
      "solver.residual_sizes",
      [=] MORTISE_HD(Index b) {
        Part p{};
        p.largest = (projector[b] * g[b]).norm() / lever[b];
        for (int k = 0; k < 3; ++k) p.sum[k] = position[b] * g[b][k];
        p.far = lever[b] * (q[b] - q0[b]).norm();
        return p;
      },
      fetch, receive);
}

void step_sizes(const Chunks& blocks, View<const Vec3> d, View<const double> lever, Fetch& fetch, ReceiveParts receive) {
  blocks.reduce(
      "solver.step_sizes",
      [=] MORTISE_HD(Index b) {
        Part p{};
        p.far = lever[b] * d[b].norm();
        return p;
      },
      fetch, receive);
}

void rounding_sizes(const Chunks& rows, const linalg::BlockMatrix& A, View<const Vec3> q, View<const Index> block_of_row, View<const double> lever,
                    View<const double> reach, Fetch& fetch, ReceiveParts receive) {
  constexpr double kEps = 2.220446049250313e-16;
  const View<const Index> start = A.row_start.view();
  const View<const Mat3> value = A.value.view();
  rows.reduce(
      "solver.rounding",
      [=] MORTISE_HD(Index r) {
        const Index b = block_of_row[r];
        Part p{};
        p.largest = p.sum[0] = 8 * kEps * value[start[r]].norm() * std::fmax(q[b].norm(), reach[b]) / lever[b];
        return p;
      },
      fetch, receive);
}

void energy_rounding(View<const Vec3> g, View<const Vec3> q, const std::vector<Index>& env_blocks, EnvValues out) {
  constexpr double kFourEps = 4 * 2.220446049250313e-16;
  device::env_sum(
      "solver.energy_rounding", env_blocks, [=] MORTISE_HD(Index b) { return kFourEps * g[b].norm() * q[b].norm(); }, out);
}

std::vector<std::pair<Index, Index>> touching(View<const model::ContactSample> samples) {
  if (samples.n == 0) return {};
  Buffer<std::uint64_t> key(samples.n);
  Buffer<Index> place(samples.n), start;
  const View<std::uint64_t> keys = key.view();
  const View<Index> places = place.view();
  device::parallel_for("solver.touching", samples.n, [=] MORTISE_HD(Index i) {
    const model::ContactSample& s = samples[i];
    const Index a = s.body_a < s.body_b ? s.body_b : s.body_a, b = s.body_a < s.body_b ? s.body_a : s.body_b;
    keys[i] = s.force == 0 ? device::kNoKey : static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b);
    places[i] = i;
  });
  device::sort_pairs(key, place);
  device::run_starts(key, start);
  Buffer<std::uint64_t> once(start.size() - 1);
  const View<std::uint64_t> out = once.view();
  const View<const std::uint64_t> sorted = std::as_const(key).view();
  const View<const Index> first = std::as_const(start).view();
  device::parallel_for("solver.pairs", out.n, [=] MORTISE_HD(Index r) { out[r] = sorted[first[r]]; });
  std::vector<std::pair<Index, Index>> pairs;
  for (std::uint64_t k : once.download()) pairs.emplace_back(static_cast<Index>(k >> 32), static_cast<Index>(k & 0xffffffffu));
  return pairs;
}

void shift_diagonal(linalg::BlockMatrix& A, double scale, const std::vector<Index>& env_rows, const std::vector<std::uint8_t>& whose) {
  if (std::find(whose.begin(), whose.end(), 1) == whose.end()) return;
  const View<const Index> start = std::as_const(A.row_start).view();
  const View<Mat3> value = A.value.view();
  std::vector<double> trace(whose.size(), 0.0);
  device::env_sum(
      "solver.trace", env_rows, [=] MORTISE_HD(Index r) { return value[start[r]].trace(); }, trace);
  for (std::size_t e = 0; e < whose.size(); ++e) {
    if (!whose[e]) continue;
    const Index first = env_rows[e], rows = env_rows[e + 1] - first;
    const double shift = scale * trace[e] / (3.0 * rows);
    device::parallel_for("solver.shift_diagonal", rows, [=] MORTISE_HD(Index r) { value[start[first + r]] += shift * Mat3::Identity(); });
  }
}

double hold_rows(linalg::BlockMatrix& A, double scale, double firm, View<const Index> list, Index begin, Index end, View<const Index> block_of_row,
                 View<const double> lever, View<const double> position) {
  if (end == begin) return 0;
  const View<const Index> start = std::as_const(A.row_start).view();
  const View<Mat3> value = A.value.view();
  std::vector<double> trace{0}, positions{0};
  Fetch fetch;
  device::env_sum(
      "solver.hold_stiffness", {begin, end}, [=] MORTISE_HD(Index i) { return position[block_of_row[list[i]]] * value[start[list[i]]].trace() / 3; },
      EnvValues{trace, fetch});
  device::env_sum(
      "solver.hold_positions", {begin, end}, [=] MORTISE_HD(Index i) { return position[block_of_row[list[i]]]; }, EnvValues{positions, fetch});
  fetch.now("hold");
  if (positions[0] == 0) return 0;
  const double k = trace[0] / positions[0];
  device::parallel_for("solver.hold", end - begin, [=] MORTISE_HD(Index i) {
    const Index r = list[begin + i];
    const double s = lever[block_of_row[r]];
    value[start[r]] += (scale * k + firm) * s * s * Mat3::Identity();
  });
  return k;
}

void clear_blocks(Buffer<Vec3>& v, Index begin, Index end) {
  if (end > begin) device::clear(v.view().p + begin, static_cast<std::size_t>(end - begin) * sizeof(Vec3));
}

void clear_not_finite(Buffer<Vec3>& v) {
  const View<Vec3> out = v.view();
  device::parallel_for("solver.clear_not_finite", out.n, [=] MORTISE_HD(Index b) {
    if (!(out[b].norm() < INFINITY)) out[b] = Vec3::Zero();
  });
}

void copy_blocks(const Buffer<Vec3>& from, Index begin, Index end, Buffer<Vec3>& to) {
  if (end > begin) device::copy(to.view().p + begin, from.view().p + begin, static_cast<std::size_t>(end - begin) * sizeof(Vec3));
}

namespace {

template <class F>
void for_ranges(const std::vector<std::uint8_t>& marks, std::uint8_t mark, const std::vector<Index>& first, F range) {
  for (std::size_t e = 0; e < marks.size(); ++e) {
    if (marks[e] != mark) continue;
    const std::size_t begin = e;
    while (e + 1 < marks.size() && marks[e + 1] == mark) ++e;
    range(first[begin], first[e + 1]);
  }
}

}  // namespace

void clear_envs(Buffer<Vec3>& v, const std::vector<std::uint8_t>& marks, std::uint8_t mark, const std::vector<Index>& first) {
  for_ranges(marks, mark, first, [&](Index begin, Index end) { clear_blocks(v, begin, end); });
}

void copy_envs(const Buffer<Vec3>& from, const std::vector<std::uint8_t>& marks, const std::vector<Index>& first, Buffer<Vec3>& to) {
  for_ranges(marks, 1, first, [&](Index begin, Index end) { copy_blocks(from, begin, end, to); });
}

void gather(View<const Vec3> from, View<const Index> place, Buffer<Vec3>& to) {
  to.resize(place.n);
  const View<Vec3> out = to.view();
  device::parallel_for("solver.gather", place.n, [=] MORTISE_HD(Index i) { out[i] = from[place[i]]; });
}

}  // namespace mortise::solver
