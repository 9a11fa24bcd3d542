#include "solver/coarse.h"

#include "solver/kernels.h"
#include "solver/tangent.h"

namespace mortise::solver {

void Coarse::add(device::View<const Vec3> in, device::View<Vec3> out) {
  step_of(in, {}, to_.rows.of_block.view(), std::as_const(to_.model.projector).view(), there_);
  lift_.transposed(std::as_const(there_).view(), here_);
  if (from_.model.ties.any()) from_.model.ties.fold(here_.view());
  f_.resize(from_.rows.count());
  f_.zero();
  add_to_rows(std::as_const(here_).view(), from_.rows.block.view(), from_.rows.projector.view(), f_.view());
  x_.resize(f_.size());
  tangent_.approximate(std::as_const(f_).view(), x_.view());
  from_.to_blocks(std::as_const(x_).view(), {}, EnvMask(1, 1), here_);
  lift_.along(std::as_const(here_).view(), there_);
  add_to_rows(std::as_const(there_).view(), to_.rows.block.view(), to_.rows.projector.view(), out);
}

}  // namespace mortise::solver
