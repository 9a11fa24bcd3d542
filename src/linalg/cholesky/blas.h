#pragma once
// The routines of BLAS and LAPACK that a factor needs, in both precisions. Matrices stand column by column; only lower triangles count.

extern "C" {
void dpotrf_(const char* uplo, const int* n, double* A, const int* lda, int* info);
void spotrf_(const char* uplo, const int* n, float* A, const int* lda, int* info);
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m, const int* n, const double* alpha, const double* A,
            const int* lda, double* B, const int* ldb);
void strsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m, const int* n, const float* alpha, const float* A,
            const int* lda, float* B, const int* ldb);
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha, const double* A, const int* lda, const double* beta,
            double* C, const int* ldc);
void ssyrk_(const char* uplo, const char* trans, const int* n, const int* k, const float* alpha, const float* A, const int* lda, const float* beta,
            float* C, const int* ldc);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k, const double* alpha, const double* A, const int* lda,
            const double* B, const int* ldb, const double* beta, double* C, const int* ldc);
void sgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k, const float* alpha, const float* A, const int* lda,
            const float* B, const int* ldb, const float* beta, float* C, const int* ldc);
void dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* A, const int* lda, double* x, const int* incx);
void strsv_(const char* uplo, const char* trans, const char* diag, const int* n, const float* A, const int* lda, float* x, const int* incx);
void dgemv_(const char* trans, const int* m, const int* n, const double* alpha, const double* A, const int* lda, const double* x, const int* incx,
            const double* beta, double* y, const int* incy);
void sgemv_(const char* trans, const int* m, const int* n, const float* alpha, const float* A, const int* lda, const float* x, const int* incx,
            const float* beta, float* y, const int* incy);
}

namespace mortise::linalg::blas {

template <class Real>
struct Routines;
template <>
struct Routines<double> {
  static constexpr auto potrf = dpotrf_;
  static constexpr auto trsm = dtrsm_;
  static constexpr auto syrk = dsyrk_;
  static constexpr auto gemm = dgemm_;
  static constexpr auto trsv = dtrsv_;
  static constexpr auto gemv = dgemv_;
};
template <>
struct Routines<float> {
  static constexpr auto potrf = spotrf_;
  static constexpr auto trsm = strsm_;
  static constexpr auto syrk = ssyrk_;
  static constexpr auto gemm = sgemm_;
  static constexpr auto trsv = strsv_;
  static constexpr auto gemv = sgemv_;
};

// A = L L^T in place; false where A is not positive definite.
template <class Real>
bool factor(int n, Real* A, int lda) {
  int info = 0;
  Routines<Real>::potrf("L", &n, A, &lda, &info);
  return info == 0;
}

// B (m x n) <- B L^-T
template <class Real>
void divide_by_transposed(int m, int n, const Real* L, int ldl, Real* B, int ldb) {
  const Real one = 1;
  Routines<Real>::trsm("R", "L", "T", "N", &m, &n, &one, L, &ldl, B, &ldb);
}

// C (n x n, lower triangle) <- - A A^T, A (n x k)
template <class Real>
void minus_square(int n, int k, const Real* A, int lda, Real* C, int ldc) {
  const Real minus = -1, none = 0;
  Routines<Real>::syrk("L", "N", &n, &k, &minus, A, &lda, &none, C, &ldc);
}

// C (m x n) <- add C - A B^T, A (m x k), B (n x k), add 0 or 1
template <class Real>
void minus_product(int m, int n, int k, const Real* A, int lda, const Real* B, int ldb, Real add, Real* C, int ldc) {
  const Real minus = -1;
  Routines<Real>::gemm("N", "T", &m, &n, &k, &minus, A, &lda, B, &ldb, &add, C, &ldc);
}

// x <- L^-1 x, or L^-T x
template <class Real>
void divide(bool transposed, int n, const Real* L, int ldl, Real* x) {
  const int one = 1;
  Routines<Real>::trsv("L", transposed ? "T" : "N", "N", &n, L, &ldl, x, &one);
}

// y <- y - A x, or y - A^T x, A (m x n)
template <class Real>
void subtract(bool transposed, int m, int n, const Real* A, int lda, const Real* x, Real* y) {
  const Real minus = -1, plus = 1;
  const int one = 1;
  Routines<Real>::gemv(transposed ? "T" : "N", &m, &n, &minus, A, &lda, x, &one, &plus, y, &one);
}

}  // namespace mortise::linalg::blas
