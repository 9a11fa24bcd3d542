#include "device/cholesky.h"

#include <cmath>

#include "base/error.h"

#ifdef MORTISE_CUSOLVER
#define DISABLE_CUSOLVER_DEPRECATED  // NVIDIA points to cuDSS, which is no part of the CUDA toolkit
#include <cusolverSp.h>
#include <cusolverSp_LOWLEVEL_PREVIEW.h>
#include <cusparse.h>
#endif

namespace mortise::device {

#ifdef MORTISE_CUSOLVER
namespace {

void ask(cusolverStatus_t status, const char* what) {
  if (status == CUSOLVER_STATUS_ALLOC_FAILED) throw Error(Exit::device, std::string("out of device memory in ") + what + "; use `linear: cg`");
  if (status != CUSOLVER_STATUS_SUCCESS) throw Error(Exit::device, std::string("cuSOLVER error ") + std::to_string(status) + " in " + what);
}

}  // namespace

struct Cholesky::State {
  cusolverSpHandle_t handle = nullptr;
  cusparseMatDescr_t general = nullptr;
  csrcholInfo_t info = nullptr;
  View<const Index> start, col;
  Buffer<char> work;

  State() {
    ask(cusolverSpCreate(&handle), "set-up");
    if (cusparseCreateMatDescr(&general) != CUSPARSE_STATUS_SUCCESS) throw Error(Exit::device, "cuSPARSE failed in set-up");
  }
  ~State() {
    if (info) cusolverSpDestroyCsrcholInfo(info);
    if (general) cusparseDestroyMatDescr(general);
    if (handle) cusolverSpDestroy(handle);
  }
};

bool Cholesky::available() { return true; }
Cholesky::Cholesky() : state_(std::make_unique<State>()) {}

void Cholesky::analyse(const Buffer<Index>& row_start, const Buffer<Index>& col) {
  State& s = *state_;
  if (s.info) cusolverSpDestroyCsrcholInfo(s.info);
  s.info = nullptr;
  s.start = row_start.view(), s.col = col.view();
  ask(cusolverSpCreateCsrcholInfo(&s.info), "analysis");
  count_launch("cusolver.analyse");
  ask(cusolverSpXcsrcholAnalysis(s.handle, s.start.n - 1, s.col.n, s.general, s.start.p, s.col.p, s.info), "analysis");
}

bool Cholesky::factor(const Buffer<double>& value) {
  State& s = *state_;
  const Index n = s.start.n - 1;
  std::size_t internal = 0, work = 0;
  ask(cusolverSpDcsrcholBufferInfo(s.handle, n, s.col.n, s.general, value.view().p, s.start.p, s.col.p, s.info, &internal, &work), "analysis");
  if (work > 0x7fffffff) throw Error(Exit::device, "the matrix is too large for the direct solver; use `linear: cg`");
  s.work.resize(static_cast<Index>(work));
  count_launch("cusolver.factor");
  ask(cusolverSpDcsrcholFactor(s.handle, n, s.col.n, s.general, value.view().p, s.start.p, s.col.p, s.info, s.work.view().p), "factorisation");
  // A pivot that is no number is none that is zero.
  const View<const double> v = value.view();
  if (!std::isfinite(max("cusolver.finite", v.n, 0, [=] MORTISE_HD(Index i) { return v[i] < 0 ? -v[i] : v[i]; }))) return false;
  int bad = -1;
  ask(cusolverSpDcsrcholZeroPivot(s.handle, s.info, 0.0, &bad), "factorisation");
  return bad < 0;
}

void Cholesky::solve(View<const double> b, View<double> x) {
  State& s = *state_;
  count_launch("cusolver.solve");
  ask(cusolverSpDcsrcholSolve(s.handle, b.n, b.p, x.p, s.info, s.work.view().p), "solution");
}

#else

struct Cholesky::State {};
bool Cholesky::available() { return false; }
Cholesky::Cholesky() { throw Error(Exit::internal, "this build has no direct solver on the device"); }
void Cholesky::analyse(const Buffer<Index>&, const Buffer<Index>&) {}
bool Cholesky::factor(const Buffer<double>&) { return false; }
void Cholesky::solve(View<const double>, View<double>) {}

#endif

Cholesky::~Cholesky() = default;

}  // namespace mortise::device
