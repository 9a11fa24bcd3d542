#pragma once
// Unsymmetric systems of some environments: GMRES, begun anew where rounding hid that it had not ended, with whatever the linear strategy has for the
// symmetric part as the preconditioner. Residuals are weighed by |r|_D, D the mean diagonal of every row's block: an energy of each row's own
// stiffness,
//
//   |r|_D^2 = sum_i |r_i|^2 / D_i,   D_i = tr A_ii / 3   [J],
//
// as what is light and soft beside something heavy is solved as closely then; |r| sees only the heavy.
#include "solver/linear.h"

namespace mortise::solver {

// From where `start` leads system.x, in the environments that it returns, to |b - J x|_D <= relative[e] |b|_D, or as near as `limit` products lead,
// which every environment has for itself; where rounding hid that it had not ended, and fewer were needed, it has them once more. x stands still
// elsewhere. start's then() as that of linalg::Awaited.
using Start = std::function<EnvMask(const std::function<void(device::Fetch&)>& then)>;
linalg::GmresResult solve_whole(const model::Model& model, const LinearSystem& system, const Start& start, const std::vector<Index>& env_rows,
                                const std::vector<double>& relative, Index limit, const linalg::Awaited& preconditioner);
// From what the preconditioner makes of b: where nothing is unsymmetric, as of a body that nothing touches, a factor's end is exact, however much
// heavier what else there is may be.
linalg::GmresResult solve_whole(const model::Model& model, const LinearSystem& system, const EnvMask& whose, const std::vector<Index>& env_rows,
                                const std::vector<double>& relative, Index limit, const linalg::Awaited& preconditioner);

}  // namespace mortise::solver
