#include "linalg/host_cg.h"

#include <cmath>
#include <utility>

namespace mortise::linalg {
namespace {

double dot(View<const Vec3> a, View<const Vec3> b) {
  return device::sum("host_cg.dot", a.n, [=] MORTISE_HD(Index i) { return a[i].dot(b[i]); });
}

// y <- y + s x
void add(double s, View<const Vec3> x, View<Vec3> y) {
  device::parallel_for("host_cg.add", x.n, [=] MORTISE_HD(Index i) { y[i] += s * x[i]; });
}

// p <- z + beta p
void turn(View<const Vec3> z, double beta, View<Vec3> p) {
  device::parallel_for("host_cg.turn", z.n, [=] MORTISE_HD(Index i) { p[i] = z[i] + beta * p[i]; });
}

}  // namespace

HostCgResult solve_on_host(const BlockMatrix& A, const Operator& preconditioner, View<const Vec3> b, View<Vec3> x, double relative, Index limit) {
  HostCgResult out;
  const Index n = b.n;
  Buffer<Vec3> r(n), z(n), p(n), Ap(n);
  device::copy(r.view().p, b.p, n * sizeof(Vec3));
  device::clear(x.p, n * sizeof(Vec3));
  p.zero();
  const double target = relative * std::sqrt(dot(b, b));
  double rz = 0;
  for (; out.iterations < limit; ++out.iterations) {
    if (std::sqrt(dot(std::as_const(r).view(), std::as_const(r).view())) <= target) {
      out.converged = true;
      return out;
    }
    preconditioner(std::as_const(r).view(), z.view());
    const double next = dot(std::as_const(r).view(), std::as_const(z).view());
    turn(std::as_const(z).view(), out.iterations == 0 ? 0 : next / rz, p.view());
    rz = next;
    multiply(A, std::as_const(p).view(), Ap.view());
    const double curvature = dot(std::as_const(p).view(), std::as_const(Ap).view());
    if (!(curvature > 0)) return out;
    add(rz / curvature, std::as_const(p).view(), x);
    add(-rz / curvature, std::as_const(Ap).view(), r.view());
  }
  out.converged = std::sqrt(dot(std::as_const(r).view(), std::as_const(r).view())) <= target;
  return out;
}

}  // namespace mortise::linalg
