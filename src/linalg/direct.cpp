#include "linalg/direct.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <tbb/task_group.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <new>
#include <vector>

#include "base/error.h"
#include "device/cholesky.h"
#include "linalg/cholesky/factor.h"
#include "linalg/cholesky/openblas.h"
#include "linalg/cholesky/order.h"
#include "linalg/cholesky/tuning.h"
#include "linalg/scalar_csr.h"

namespace mortise::linalg {
namespace {

using Clock = std::chrono::steady_clock;
// OpenBLAS asks for 128 MiB of addresses a thread, and asks again for ever where a limit (ulimit -v) gives it none.
void require_addresses() {
  rlimit limit = {};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  const std::size_t bytes = (static_cast<std::size_t>(device::threads()) + 1) << 27;
  void* probe = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (probe == MAP_FAILED) throw Error(Exit::device, "out of memory: the limit on address space (ulimit -v) leaves no room for the direct solver");
  munmap(probe, bytes);
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

struct DirectSolver::State {
  DirectStats stats;
  std::uint64_t pattern = 0;  // that has been analysed
  Order order;
  cholesky::Supernodes supernodes;
  std::unique_ptr<cholesky::Factor<double>> full;
  std::unique_ptr<cholesky::Factor<float>> rough;
  Precision precision = Precision::full;
  bool factored = false;
  std::vector<Vec3> b;  // of a solve

  // Where the device has a direct solver of its own, it does all but the ordering.
  struct OnDevice {
    device::Cholesky cholesky;
    ScalarCsr matrix;
    Buffer<double> b, x;
  };
  std::unique_ptr<OnDevice> on_device;

  // An order that is being found on another thread.
  struct Search {
    Order found;
    tbb::task_group task;
    ~Search() {
      task.cancel();
      task.wait();
    }
  };
  std::unique_ptr<Search> search;

  void find_order_beside(std::vector<Index> row_start, std::vector<Index> col) {
    search = std::make_unique<Search>();
    search->task.run([s = search.get(), row_start = std::move(row_start), col = std::move(col)] {
      s->found.rows = cholesky::find_order(row_start, col);
      s->found.flops = cholesky::find_supernodes(row_start, col, s->found.rows).flops.back();
    });
  }
  void take_found() {
    if (!search) return;
    const std::unique_ptr<Search> done = std::move(search);
    done->task.wait();
    order = std::move(done->found);
    pattern = 0;
    ++stats.orderings;
  }

  void analyse(const BlockMatrix& A) {
    const auto start = Clock::now();
    take_found();
    pattern = 0;
    stats.unknowns = 3 * A.rows;
    std::vector<Index> row_start = A.row_start.download(), col = A.col.download();
    const bool kept = static_cast<Index>(order.rows.size()) == A.rows;
    if (kept) supernodes = cholesky::find_supernodes(row_start, col, order.rows);
    const double grown = kept ? supernodes.flops.back() / order.flops : INFINITY;
    if (grown > cholesky::tuning::kFarOutgrown) {
      order.rows = cholesky::find_order(row_start, col);
      supernodes = cholesky::find_supernodes(row_start, col, order.rows);
      order.flops = supernodes.flops.back();
      ++stats.orderings;
    } else if (grown > cholesky::tuning::kOutgrown) {
      find_order_beside(std::move(row_start), std::move(col));
    }
    pattern = A.pattern;
    ++stats.analyses;
    stats.factor_entries = 0;
    for (Index s = 0; s < supernodes.count(); ++s) {
      const double k = 3.0 * supernodes.columns(s), rows = 3.0 * supernodes.rows(s);
      stats.factor_entries += k * rows - k * (k - 1) / 2;
    }
    stats.factor_flops = supernodes.flops.back();
    stats.analyse_seconds = seconds_since(start);
  }

  template <class Real>
  bool compute(std::unique_ptr<cholesky::Factor<Real>>& factor, const std::vector<Mat3>& value) {
    if (!factor) factor = std::make_unique<cholesky::Factor<Real>>();
    const bool done = factor->compute(supernodes, value.data());
    stats.memory = factor->bytes();
    stats.reciprocal_condition = done ? factor->reciprocal_condition() : 0;
    return done;
  }

  bool factor_on_device(const BlockMatrix& A);
  void solve_on_device(View<const Vec3> b, View<Vec3> x);
};

bool DirectSolver::State::factor_on_device(const BlockMatrix& A) {
  if (!on_device) on_device = std::make_unique<OnDevice>();
  if (A.pattern != pattern || pattern == 0) {
    const auto start = Clock::now();
    stats.unknowns = 3 * A.rows;
    on_device->matrix.set_pattern(A, cholesky::find_order(A.row_start.download(), A.col.download()));
    on_device->cholesky.analyse(on_device->matrix.row_start(), on_device->matrix.col());
    on_device->b.resize(stats.unknowns), on_device->x.resize(stats.unknowns);
    pattern = A.pattern;
    ++stats.analyses;
    stats.analyse_seconds = seconds_since(start);
  }
  const auto start = Clock::now();
  on_device->matrix.set_values(A);
  factored = on_device->cholesky.factor(on_device->matrix.value());
  ++stats.factorisations;
  stats.factor_seconds = seconds_since(start);
  return factored;
}

void DirectSolver::State::solve_on_device(View<const Vec3> b_of_rows, View<Vec3> x_of_rows) {
  on_device->matrix.to(b_of_rows, on_device->b.view());
  on_device->cholesky.solve(std::as_const(on_device->b).view(), on_device->x.view());
  on_device->matrix.from(std::as_const(on_device->x).view(), x_of_rows);
  ++stats.solves;
}

DirectSolver::DirectSolver() : state_(std::make_unique<State>()) {}
DirectSolver::~DirectSolver() = default;

const DirectSolver::Order& DirectSolver::order() const { return state_->order; }

void DirectSolver::set_order(Order order) {
  State& s = *state_;
  s.search.reset();
  if (order.rows != s.order.rows) s.pattern = 0;
  s.order = std::move(order);
}

void DirectSolver::settle_order() { state_->take_found(); }

bool DirectSolver::factor(const BlockMatrix& A, Precision wanted) {
  State& s = *state_;
  s.factored = false;
  if (A.rows == 0) return true;
  if (device::Cholesky::available()) return s.factor_on_device(A);
  require_addresses();
  ready_openblas();
  try {
    if (A.pattern != s.pattern || s.pattern == 0) s.analyse(A);
    const auto start = Clock::now();
    std::vector<Mat3> value(A.value.size());
    device::copy_out(value.data(), A.value.view().p, value.size() * sizeof(Mat3), "matrix for the host");
    s.precision = wanted == Precision::full ? Precision::full : Precision::rough;
    s.factored = s.precision == Precision::rough && s.compute(s.rough, value);
    if (s.factored) {
      s.full.reset();
    } else if (wanted != Precision::trial) {
      s.precision = Precision::full;
      s.rough.reset();
      s.factored = s.compute(s.full, value);
    }
    ++s.stats.factorisations;
    s.stats.factor_seconds = seconds_since(start);
  } catch (const std::bad_alloc&) {
    throw Error(Exit::device, "out of memory in the direct solver (" + std::to_string(s.stats.unknowns) + " unknowns); use `linear: cg`");
  }
  return s.factored;
}

Precision DirectSolver::precision() const { return state_->precision; }

void DirectSolver::solve(View<const Vec3> b, View<Vec3> x) {
  State& s = *state_;
  if (b.n == 0) return;
  if (!s.factored || 3 * b.n != s.stats.unknowns || x.n != b.n) throw Error(Exit::internal, "direct solve without a matching factorisation");
  if (s.on_device) return s.solve_on_device(b, x);
  const auto start = Clock::now();
  const std::size_t bytes = static_cast<std::size_t>(b.n) * sizeof(Vec3);
  s.b.resize(b.n);
  device::copy_out(s.b.data(), b.p, bytes, "right-hand side for the host");
  if (s.precision == Precision::full)
    s.full->solve(s.supernodes, s.b.data(), s.b.data());
  else
    s.rough->solve(s.supernodes, s.b.data(), s.b.data());
  device::copy_in(x.p, s.b.data(), bytes);
  ++s.stats.solves;
  s.stats.solve_seconds = seconds_since(start);
}

const DirectStats& DirectSolver::stats() const { return state_->stats; }

}  // namespace mortise::linalg
