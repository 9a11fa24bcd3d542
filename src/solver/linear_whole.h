#pragma once
// Unsymmetric systems of some environments: GMRES, begun anew where rounding hid that it had not ended, with whatever the linear strategy has for the
// symmetric part as the preconditioner.
#include "solver/linear.h"

namespace mortise::solver {

// From system.x to |b - J x| <= relative[e] |b|, or as near as `most` products of the environment that takes most lead. x stands still outside of
// `whose`.
linalg::GmresResult solve_whole(const LinearSystem& system, const EnvMask& whose, const std::vector<Index>& env_rows,
                                const std::vector<double>& relative, Index most, const linalg::Operator& preconditioner);

}  // namespace mortise::solver
