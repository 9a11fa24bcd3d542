#pragma once
// Multilevel additive Schwarz (Wu, Wang and Wang, "A GPU-based multilevel additive Schwarz preconditioner for cloth and deformable
// body simulation", ACM TOG 41(4), 2022):
//
//   M^-1 = sum over levels l of  w_l P_l (sum over domains d of R_d^T (R_d A_l R_d^T)^-1 R_d) P_l^T,   A_l = P_l^T A P_l,
//
// with the domains of domains.h. Where the paper's coarse functions are constant on an item, ours are its rigid motions: rows
// move by x = w t + omega x d, with w = 1 and d = q - w c for a node or the position of an affine body, w = 0 and d = q for an axis (c: the item's
// centre). A free body's motion costs no energy, so these carry what is slow to converge.
// Every environment has domains of its own, all sums have a fixed order: bits depend neither on neighbours nor on threads.
#include "device/room.h"
#include "linalg/domain_inverse.h"
#include "linalg/domains.h"
#include "linalg/grouping.h"
#include "linalg/preconditioner.h"

namespace mortise::linalg {

// Rigid motions of the items of a level act on this matrix A_l: its upper blocks, of translation and rotation each.
struct CoarseMatrix {
  Index first = 0, items = 0;  // the level's items among all coarse ones
  Grouping terms;              // blocks of the level below by the block they go into
  device::Room room;           // for how many there are, among the blocks of A
  Index there = 0;
  Buffer<Index> row, col;  // items, row <= col
  Buffer<Eigen::Matrix<double, 6, 6>> value;
};

class Schwarz : public Preconditioner {
 public:
  Schwarz(const RowPlaces& rows, const std::vector<Index>& env_rows);

  void choose(const std::vector<std::uint8_t>&) override {}  // all that there are; several: per_environment.h
  void build(const BlockMatrix& A, View<const Vec3> position) override;
  void apply(View<const Vec3> r, View<Vec3> z) const override;
  View<const Index> bad_rows() const override { return bad_.view(); }
  std::vector<const void*> memory() const override { return {this, row_slot_.view().p, domains_.inverse.view().p}; }

  Index levels() const { return 1 + static_cast<Index>(coarse_.size()); }
  std::size_t bytes() const;

 private:
  void find_patterns(const BlockMatrix& A);
  bool group_levels(const BlockMatrix& A, bool within);

  std::uint64_t pattern_ = 0;
  // Rows; then the coarse items of all levels, one level after another.
  Buffer<Index> row_slot_, row_parent_, bad_;
  Buffer<double> row_moves_;
  Buffer<Vec3> row_place_, row_arm_;  // q, and d about the parent's centre [m]
  Buffer<Index> slot_, parent_, member_start_, member_;
  Buffer<Vec3> centre_, arm_;
  std::vector<CoarseMatrix> coarse_;

  DomainMatrices domains_;
  Buffer<Index> row_of_slot_;
  mutable Buffer<Vec3> restricted_, half_, solved_;  // per slot: P^T r, X P^T r, X^T X P^T r
};

}  // namespace mortise::linalg
