#pragma once
// The solver's own kernels on arrays of 3-vectors, one per block. Reductions are per environment and of fixed order.
#include <functional>
#include <utility>

#include "linalg/block_matrix.h"
#include "linalg/stencils.h"
#include "model/contact_view.h"
#include "model/model.h"
#include "solver/body_figures.h"

namespace mortise::solver {

using device::Buffer;
using device::EnvValues;
using device::Fetch;
using device::View;
using ReceiveParts = std::function<void(const std::vector<Part>&)>;

// Per environment the largest |v|.
void largest(View<const Vec3> v, const std::vector<Index>& env_blocks, EnvValues out);
std::vector<double> largest(View<const Vec3> v, const std::vector<Index>& env_blocks);
// Per environment a . b.
void dot(View<const Vec3> a, View<const Vec3> b, const std::vector<Index>& env_blocks, EnvValues out);
std::vector<double> dot(View<const Vec3> a, View<const Vec3> b, const std::vector<Index>& env_blocks);
// c = (I - P)(target - q): what the supports still have to move.
void support_move(View<const Vec3> q, View<const Vec3> target, View<const Mat3> projector, Buffer<Vec3>& c);
// Overwrites the stencils' gradients by H d, so that assembling them gives the product with the full Hessian. Of environments that are worked on.
void stencil_product(linalg::StencilSet& set, const model::Model& model, View<const Vec3> d);
// rhs_row = -P (g + Hc) at the block of the row.
void right_hand_side(View<const Vec3> g, View<const Vec3> Hc, View<const Index> block_of_row, View<const Mat3> row_projector, Buffer<Vec3>& rhs);
// out_row += P g at the block of the row, for the rows of `whose`.
void add_to_rows(View<const Vec3> g, const device::Ranges& whose, View<const Index> block_of_row, View<const Mat3> row_projector, View<Vec3> out);
// dq_b = P x_row(b) + c_b; c may be empty.
void step_of(View<const Vec3> x, View<const Vec3> c, View<const Index> row_of_block, View<const Mat3> projector, Buffer<Vec3>& dq);
// trial = q + alpha_env dq; where alpha is exactly 1 the held directions land exactly on their targets, and what is tied exactly on what it follows.
void advance(View<const Vec3> q, View<const Vec3> dq, const std::vector<double>& alpha, const model::Model& model, Buffer<Vec3>& trial);
void add(View<const Vec3> from, Buffer<Vec3>& to);
void add(View<const Vec3> from, const device::Ranges& where, Buffer<Vec3>& to);
void subtract(View<const Vec3> a, View<const Vec3> b, Buffer<Vec3>& out);
// to_b += scale_env v_b
void add_scaled(View<const Vec3> v, const std::vector<double>& scale, View<const Index> block_env, Buffer<Vec3>& to);
// 0 of no values.
double largest_of(const std::vector<double>& v);
// Into Part, see convergence.h for levers and positions: largest = |P g|/s, sum[0] = |g| over positions.
void force_sizes(const Chunks& blocks, View<const Vec3> g, View<const Mat3> projector, View<const double> lever, View<const double> position,
                 Fetch& fetch, ReceiveParts receive);
// largest = |P g|/s, sum = g over positions, far = s |q - q0|.
void residual_sizes(const Chunks& blocks, View<const Vec3> g, View<const Mat3> projector, View<const double> lever, View<const double> position,
                    View<const Vec3> q, View<const Vec3> q0, Fetch& fetch, ReceiveParts receive);
// far = s |d|.
void step_sizes(const Chunks& blocks, View<const Vec3> d, View<const double> lever, Fetch& fetch, ReceiveParts receive);
// Of rows, largest and sum[0] = 8 eps |A_rr| |q_r| / s: positions are only known to eps |q|, and forces accordingly.
void rounding_sizes(const Chunks& rows, const linalg::BlockMatrix& A, View<const Vec3> q, View<const Index> block_of_row, View<const double> lever,
                    View<const double> reach, Fetch& fetch, ReceiveParts receive);
// Per environment 4 eps sum_b |g_b| |q_b| is added: what the energy with the gradient g may change by because positions are rounded.
void energy_rounding(View<const Vec3> g, View<const Vec3> q, const std::vector<Index>& env_blocks, EnvValues out);
// Pairs of bodies of samples that carry force, as (larger number, smaller number), each once.
std::vector<std::pair<Index, Index>> touching(View<const model::ContactSample> samples);
// A <- A + scale * (mean trace of the diagonal blocks / 3) * I, in the environments of `whose`, each with a mean of its own.
void shift_diagonal(linalg::BlockMatrix& A, double scale, const std::vector<Index>& env_rows, const std::vector<std::uint8_t>& whose);
// The mean k of trace A_rr / 3 over the positions among the rows list[begin..end), and A_rr += (scale k + firm) s^2 I of all of them, with s the
// lever of the block of the row (convergence.h). Returns k.
double hold_rows(linalg::BlockMatrix& A, double scale, double firm, View<const Index> list, Index begin, Index end, View<const Index> block_of_row,
                 View<const double> lever, View<const double> position);
// v[begin..end) <- 0, or those of `from`.
void clear_blocks(Buffer<Vec3>& v, Index begin, Index end);
// Those without a finite length.
void clear_not_finite(Buffer<Vec3>& v);
void copy_blocks(const Buffer<Vec3>& from, Index begin, Index end, Buffer<Vec3>& to);
// The same of the environments whose mark is `mark`, of which each owns [first[e], first[e+1]); those side by side in one go.
void clear_envs(Buffer<Vec3>& v, const std::vector<std::uint8_t>& marks, std::uint8_t mark, const std::vector<Index>& first);
void copy_envs(const Buffer<Vec3>& from, const std::vector<std::uint8_t>& marks, const std::vector<Index>& first, Buffer<Vec3>& to);
// to_i = from_place(i)
void gather(View<const Vec3> from, View<const Index> place, Buffer<Vec3>& to);

}  // namespace mortise::solver
