#include "linalg/direct.h"

#include <cholmod.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/error.h"
#include "device/cholesky.h"
#include "linalg/scalar_csr.h"

extern "C" void openblas_set_num_threads(int);
extern "C" int openblas_get_num_threads(void);
extern "C" void omp_set_max_active_levels(int);

namespace mortise::linalg {
namespace {

using Clock = std::chrono::steady_clock;
// OpenBLAS asks for 128 MiB of addresses a thread, and asks again for ever where a limit (ulimit -v) gives it none.
void require_addresses(int threads) {
  rlimit limit = {};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  const std::size_t bytes = (static_cast<std::size_t>(std::max(threads, 1)) + 1) << 27;
  void* probe = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (probe == MAP_FAILED) throw Error(Exit::device, "out of memory: the limit on address space (ulimit -v) leaves no room for the direct solver");
  munmap(probe, bytes);
}

// Of the calling thread. OpenBLAS is only told what it does not know: in a copy of a process being told starts all its threads again, which wait
// in a loop at first. CHOLMOD would start four threads of its own, whatever was asked for, which do little but wait for each other: a sixth
// of the CPU time of a factor.
void limit_threads(int blas_threads) {
  if (openblas_get_num_threads() != blas_threads) openblas_set_num_threads(blas_threads);
  omp_set_max_active_levels(0);
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double norm(const cholmod_dense* v) {
  const double* p = static_cast<const double*>(v->x);
  double s = 0;
  for (std::size_t i = 0; i < v->nzmax; ++i) s += p[i] * p[i];
  return std::sqrt(s);
}

}  // namespace

void use_one_blas_thread() { limit_threads(1); }

struct DirectSolver::State {
  DirectOptions options;
  DirectStats stats;
  cholmod_common common;
  cholmod_sparse* matrix = nullptr;  // scalar lower triangle: column 3r+i holds row i of the upper blocks of row r
  cholmod_factor* factor = nullptr;
  cholmod_dense *b = nullptr, *x = nullptr, *residual = nullptr, *work_y = nullptr, *work_e = nullptr;
  std::uint64_t pattern = 0;
  std::vector<Index> row_start, col;
  Index failed_row = -1;
  bool factored = false;

  // Where the device has a direct solver of its own, it does all but the ordering.
  struct OnDevice {
    device::Cholesky cholesky;
    ScalarCsr matrix;
    Buffer<double> b, x;
  };
  std::unique_ptr<OnDevice> on_device;

  State() {
    cholmod_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.quick_return_if_not_posdef = 1;
  }
  ~State() {
    free_all();
    cholmod_finish(&common);
  }
  void free_all() {
    cholmod_free_sparse(&matrix, &common);
    cholmod_free_factor(&factor, &common);
    for (cholmod_dense** v : {&b, &x, &residual, &work_y, &work_e}) cholmod_free_dense(v, &common);
  }
  // Any failure but "not positive definite" ends the solve.
  void check(const char* what) const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE)
      throw Error(Exit::device, std::string("out of memory in ") + what + " of the direct solver (" + std::to_string(stats.unknowns) +
                                    " unknowns); use `linear: cg`");
    if (common.status < 0) throw Error(Exit::internal, std::string("CHOLMOD error ") + std::to_string(common.status) + " in " + what);
  }

  void analyse(const BlockMatrix& A);
  bool factor_on_device(const BlockMatrix& A);
  void solve_on_device(View<const Vec3> b, View<Vec3> x);
  std::vector<int> block_ordering();
  void expand_pattern(Index rows);
  void expand_values(const BlockMatrix& A);
};

// Fill-reducing permutation of the block rows.
std::vector<int> DirectSolver::State::block_ordering() {
  const std::size_t rows = row_start.size() - 1;
  cholmod_sparse* graph = cholmod_allocate_sparse(rows, rows, col.size(), 1, 1, -1, CHOLMOD_PATTERN, &common);
  check("ordering");
  std::copy(row_start.begin(), row_start.end(), static_cast<int*>(graph->p));
  std::copy(col.begin(), col.end(), static_cast<int*>(graph->i));
  std::vector<int> order(rows);
  stats.ordering = "metis";
  bool done = cholmod_metis(graph, nullptr, 0, 1, order.data(), &common);
  if (!done) {
    stats.ordering = "amd";
    done = cholmod_amd(graph, nullptr, 0, order.data(), &common);
  }
  cholmod_free_sparse(&graph, &common);
  if (!done) check("ordering");
  return order;
}

void DirectSolver::State::expand_pattern(Index rows) {
  std::size_t entries = 0;
  for (Index r = 0; r < rows; ++r) entries += 9 * static_cast<std::size_t>(row_start[r + 1] - row_start[r]) - 3;
  if (entries > 0x7fffffff) throw Error(Exit::device, "the matrix is too large for the direct solver; use `linear: cg`");
  const std::size_t n = 3 * static_cast<std::size_t>(rows);
  matrix = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, &common);
  check("analysis");
  int* start = static_cast<int*>(matrix->p);
  int* row = static_cast<int*>(matrix->i);
  int at = 0;
  for (Index r = 0; r < rows; ++r)
    for (int i = 0; i < 3; ++i) {
      start[3 * r + i] = at;
      for (Index k = row_start[r]; k < row_start[r + 1]; ++k)
        for (int j = k == row_start[r] ? i : 0; j < 3; ++j) row[at++] = 3 * col[k] + j;
    }
  start[3 * rows] = at;
}

void DirectSolver::State::expand_values(const BlockMatrix& A) {
  const std::vector<Mat3> value = A.value.download();
  double* to = static_cast<double*>(matrix->x);
  for (Index r = 0; r < A.rows; ++r)
    for (int i = 0; i < 3; ++i)
      for (Index k = row_start[r]; k < row_start[r + 1]; ++k)
        for (int j = k == row_start[r] ? i : 0; j < 3; ++j) *to++ = value[k](i, j);
}

void DirectSolver::State::analyse(const BlockMatrix& A) {
  const auto start = Clock::now();
  free_all();
  pattern = 0;
  row_start = A.row_start.download();
  col = A.col.download();
  stats.unknowns = 3 * A.rows;
  expand_pattern(A.rows);
  const std::vector<int> blocks = block_ordering();
  std::vector<int> order(3 * blocks.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = 3 * blocks[k / 3] + static_cast<int>(k % 3);
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_GIVEN;
  factor = cholmod_analyze_p(matrix, order.data(), nullptr, 0, &common);
  check("analysis");
  const std::size_t n = 3 * static_cast<std::size_t>(A.rows);
  b = cholmod_allocate_dense(n, 1, n, CHOLMOD_REAL, &common);
  residual = cholmod_allocate_dense(n, 1, n, CHOLMOD_REAL, &common);
  check("analysis");
  pattern = A.pattern;
  ++stats.analyses;
  stats.factor_entries = common.lnz;
  stats.factor_flops = common.fl;
  stats.analyse_seconds = seconds_since(start);
}

bool DirectSolver::State::factor_on_device(const BlockMatrix& A) {
  if (!on_device) on_device = std::make_unique<OnDevice>();
  if (A.pattern != pattern || pattern == 0) {
    const auto start = Clock::now();
    row_start = A.row_start.download();
    col = A.col.download();
    stats.unknowns = 3 * A.rows;
    on_device->matrix.set_pattern(A, block_ordering());
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

DirectSolver::DirectSolver(DirectOptions options) : state_(std::make_unique<State>()) { state_->options = options; }
DirectSolver::~DirectSolver() = default;

bool DirectSolver::factor(const BlockMatrix& A) {
  State& s = *state_;
  s.failed_row = -1;
  s.factored = false;
  if (A.rows == 0) return true;
  if (device::Cholesky::available()) return s.factor_on_device(A);
  require_addresses(s.options.blas_threads);
  limit_threads(s.options.blas_threads);
  if (A.pattern != s.pattern || s.pattern == 0) s.analyse(A);
  const auto start = Clock::now();
  s.expand_values(A);
  const bool done = cholmod_factorize(s.matrix, s.factor, &s.common);
  s.check("factorisation");
  ++s.stats.factorisations;
  s.stats.factor_seconds = seconds_since(start);
  s.stats.memory = s.common.memory_usage;
  if (!done || s.common.status == CHOLMOD_NOT_POSDEF) {
    s.failed_row = static_cast<const int*>(s.factor->Perm)[s.factor->minor] / 3;
    return false;
  }
  // A NaN in A passes CHOLMOD's pivot test, but not this one.
  s.stats.reciprocal_condition = cholmod_rcond(s.factor, &s.common);
  s.factored = s.stats.reciprocal_condition > 0;
  return s.factored;
}

Index DirectSolver::failed_row() const { return state_->failed_row; }

double DirectSolver::solve(View<const Vec3> b, View<Vec3> x, int refinements) {
  State& s = *state_;
  if (b.n == 0) return refinements > 0 ? 0 : -1;
  if (!s.factored || 3 * b.n != s.stats.unknowns || x.n != b.n) throw Error(Exit::internal, "direct solve without a matching factorisation");
  if (s.on_device) {
    s.solve_on_device(b, x);
    return -1;
  }
  limit_threads(s.options.blas_threads);
  const auto start = Clock::now();
  const std::size_t bytes = static_cast<std::size_t>(b.n) * sizeof(Vec3);
  device::copy_out(s.b->x, b.p, bytes);
  cholmod_solve2(CHOLMOD_A, s.factor, s.b, nullptr, &s.x, nullptr, &s.work_y, &s.work_e, &s.common);
  s.check("solution");
  double relative = -1;
  if (refinements > 0) {
    std::vector<double> total(static_cast<double*>(s.x->x), static_cast<double*>(s.x->x) + 3 * b.n);
    double minus[2] = {-1, 0}, one[2] = {1, 0};
    for (int step = 0; step <= refinements; ++step) {
      std::memcpy(s.x->x, total.data(), bytes);
      std::memcpy(s.residual->x, s.b->x, bytes);
      cholmod_sdmult(s.matrix, 0, minus, one, s.x, s.residual, &s.common);
      const double b_norm = norm(s.b);
      relative = b_norm > 0 ? norm(s.residual) / b_norm : 0;
      if (step == refinements) break;
      cholmod_solve2(CHOLMOD_A, s.factor, s.residual, nullptr, &s.x, nullptr, &s.work_y, &s.work_e, &s.common);
      s.check("solution");
      for (std::size_t i = 0; i < total.size(); ++i) total[i] += static_cast<double*>(s.x->x)[i];
    }
    std::memcpy(s.x->x, total.data(), bytes);
  }
  device::copy_in(x.p, s.x->x, bytes);
  ++s.stats.solves;
  s.stats.solve_seconds = seconds_since(start);
  return relative;
}

const DirectStats& DirectSolver::stats() const { return state_->stats; }

}  // namespace mortise::linalg
