#include "linalg/supports.h"

namespace mortise::linalg {

void project(BlockMatrix& A, View<const Mat3> P) {
  const View<const Index> row = A.row.view(), col = A.col.view();
  const View<Mat3> value = A.value.view();
  device::parallel_for("matrix.project", A.upper_blocks(), [=] MORTISE_HD(Index k) {
    const Mat3 right = value[k] * P[col[k]];
    Mat3 out = P[row[k]] * right;
    if (row[k] == col[k]) out += Mat3::Identity() - P[row[k]];
    value[k] = out;
  });
}

}  // namespace mortise::linalg
