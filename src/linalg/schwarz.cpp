#include "linalg/schwarz.h"

#include <algorithm>
#include <utility>

namespace mortise::linalg {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// [d]x v = d x v
MORTISE_HD inline Mat3 cross(const Vec3& d) {
  Mat3 out = Mat3::Zero();
  out(0, 1) = -d[2], out(0, 2) = d[1], out(1, 2) = -d[0];
  out(1, 0) = d[2], out(2, 0) = -d[1], out(2, 1) = d[0];
  return out;
}

// P_i^T G P_j with P = [w I, -[d]x], the motion of a row.
MORTISE_HD inline Mat6 row_term(const Mat3& G, double wi, const Vec3& di, double wj, const Vec3& dj) {
  const Mat3 left = cross(di) * G, right = G * cross(dj);
  Mat6 out;
  out.block<3, 3>(0, 0) = wi * wj * G;
  out.block<3, 3>(0, 3) = -wi * right;
  out.block<3, 3>(3, 0) = wj * left;
  out.block<3, 3>(3, 3) = -(left * cross(dj));
  return out;
}

// P_i^T V P_j with P = [I, -[d]x; 0, I], the motion of a coarse item.
MORTISE_HD inline Mat6 item_term(const Mat6& V, const Vec3& di, const Vec3& dj) {
  Mat6 out = V;
  const Mat3 right = cross(dj), left = cross(di);
  const Mat3 tt = V.block<3, 3>(0, 0), wt = V.block<3, 3>(3, 0);
  out.block<3, 3>(0, 3) -= tt * right;
  out.block<3, 3>(3, 3) -= wt * right;
  const Mat3 t0 = out.block<3, 3>(0, 0), t1 = out.block<3, 3>(0, 3);
  out.block<3, 3>(3, 0) += left * t0;
  out.block<3, 3>(3, 3) += left * t1;
  return out;
}

// Squared lengths of e_k x d, weighted by `size`: what the size of a translation adds to that of the rotations.
MORTISE_HD inline Vec3 turned(const Vec3& size, const Vec3& d) {
  const Vec3 s = d.cwiseProduct(d);
  return Vec3(size[1] * s[2] + size[2] * s[1], size[2] * s[0] + size[0] * s[2], size[0] * s[1] + size[1] * s[0]);
}

// How a block of a level enters the upper block of the two items of the next level.
MORTISE_HD inline Mat6 placed(const Mat6& term, bool diagonal, Index row, Index col) {
  if (row == col && !diagonal) return term + term.transpose();
  if (row > col) return term.transpose();
  return term;
}

// Keys of the blocks of the next level, for the blocks (row, col) of this one; `first` is the next level's first item. A row of -1 is none.
Buffer<std::uint64_t> keys_of_parents(View<const Index> row, View<const Index> col, View<const Index> parent, const CoarseMatrix& of) {
  Buffer<std::uint64_t> keys(row.n);
  const View<std::uint64_t> key = keys.view();
  const Index first = of.first, items = of.items;
  const std::uint64_t limit = block_key(items, 0, items);
  device::parallel_for("schwarz.keys", row.n, [=] MORTISE_HD(Index k) {
    const Index i = row[k] < 0 ? -1 : parent[row[k]] - first, j = row[k] < 0 ? -1 : parent[col[k]] - first;
    key[k] = i < 0 || j < 0 ? limit : i <= j ? block_key(i, j, items) : block_key(j, i, items);
  });
  return keys;
}

// The blocks of a level from their groups; those for which there was room only have row -1.
void shape(CoarseMatrix& out) {
  const Index n = out.terms.groups, first = out.first, items = out.items;
  const std::uint64_t limit = block_key(items, 0, items);
  out.row.resize(n), out.col.resize(n), out.value.resize(n);
  const View<const std::uint64_t> found = out.terms.key.view();
  const View<Index> r = out.row.view(), c = out.col.view();
  device::parallel_for("schwarz.keys", n, [=] MORTISE_HD(Index k) {
    const bool there = found[k] < limit;
    r[k] = there ? first + static_cast<Index>(found[k] / static_cast<std::uint64_t>(items)) : -1;
    c[k] = there ? first + static_cast<Index>(found[k] % static_cast<std::uint64_t>(items)) : -1;
  });
}

// Level 0: the blocks of A between rows of one domain, and their diagonal as sizes.
void fill_fine(const BlockMatrix& A, View<const Index> slot, DomainMatrices& domains) {
  const View<const Index> row = A.row.view(), col = A.col.view();
  const View<const Mat3> value = A.value.view();
  const View<Mat3> lower = domains.lower.view();
  const View<Vec3> size = domains.size.view();
  device::parallel_for("schwarz.fill", A.upper_blocks(), [=] MORTISE_HD(Index k) {
    const Index si = slot[row[k]], sj = slot[col[k]], d = si / kSlots;
    if (d != sj / kSlots) return;
    const Index a = si % kSlots, b = sj % kSlots;
    const Mat3 G = value[k];
    if (a < b)
      lower[d * kPacked + packed_place(b, a)] = G.transpose();
    else
      lower[d * kPacked + packed_place(a, b)] = G;
    if (a == b) size[si] = G.diagonal();
  });
}

void fill_coarse(const CoarseMatrix& A, View<const Index> slot, DomainMatrices& domains) {
  const View<const Index> row = A.row.view(), col = A.col.view();
  const View<const Mat6> value = A.value.view();
  const View<Mat3> lower = domains.lower.view();
  device::parallel_for("schwarz.fill", row.n, [=] MORTISE_HD(Index k) {
    if (row[k] < 0) return;
    const Index si = slot[row[k]], sj = slot[col[k]], d = si / kSlots;
    if (d != sj / kSlots) return;
    const Index a = si % kSlots, b = sj % kSlots, at = d * kPacked;
    for (Index u = 0; u < 2; ++u)
      for (Index v = 0; v < 2; ++v) {
        const Mat3 G = value[k].block<3, 3>(3 * u, 3 * v);
        if (a + u >= b + v)
          lower[at + packed_place(a + u, b + v)] = G;
        else if (a != b)
          lower[at + packed_place(b + v, a + u)] = G.transpose();
      }
  });
}

}  // namespace

Schwarz::Schwarz(const RowPlaces& rows, const std::vector<Index>& env_rows) {
  const Domains domains = make_domains(rows, env_rows);
  domains_.resize(domains);
  const Index slots = domains_.domains * kSlots;
  restricted_.resize(slots), half_.resize(slots), solved_.resize(slots);

  const DomainLevel& fine = domains.levels[0];
  std::vector<Index> row_of_slot(slots, -1);
  for (Index i = 0; i < fine.items(); ++i) row_of_slot[fine.slot[i]] = i;
  row_of_slot_.upload(row_of_slot);
  row_slot_.upload(fine.slot), row_parent_.upload(fine.parent), row_moves_.upload(rows.moves);
  bad_.resize(fine.items()), row_place_.resize(fine.items()), row_arm_.resize(fine.items());

  std::vector<Index> slot, parent, start{0}, member;
  for (std::size_t l = 1; l < domains.levels.size(); ++l) {
    const DomainLevel &level = domains.levels[l], &below = domains.levels[l - 1];
    const Index first = static_cast<Index>(slot.size()), first_below = l == 1 ? 0 : coarse_.back().first;
    coarse_.emplace_back();
    coarse_.back().first = first, coarse_.back().items = level.items();
    slot.insert(slot.end(), level.slot.begin(), level.slot.end());
    for (Index p : level.parent) parent.push_back(p < 0 ? -1 : first + level.items() + p);
    for (Index i = 0; i < level.items(); ++i) {
      for (Index k = below.member_start[i]; k < below.member_start[i + 1]; ++k) member.push_back(first_below + below.member[k]);
      start.push_back(static_cast<Index>(member.size()));
    }
  }
  slot_.upload(slot), parent_.upload(parent), member_start_.upload(start), member_.upload(member);
  centre_.resize(slot_.size()), arm_.resize(slot_.size());
}

std::size_t Schwarz::bytes() const {
  std::size_t n = domains_.lower.bytes() + domains_.size.bytes() + domains_.pivot.bytes() + domains_.inverse.bytes() + restricted_.bytes() * 3 +
                  row_place_.bytes() * 2 + row_slot_.bytes() * 3 + row_moves_.bytes() + centre_.bytes() * 2 + slot_.bytes() * 3 +
                  row_of_slot_.bytes();
  for (const CoarseMatrix& A : coarse_) n += A.value.bytes() + A.row.bytes() * 2 + A.terms.term.bytes() + A.terms.key.bytes();
  return n;
}

// With room for as many blocks of every level as there were last time and some more the host hears of all levels at once; else of one after the
// other. False where the room was too small.
bool Schwarz::group_levels(const BlockMatrix& A, bool within) {
  device::Fetch fetch;
  const Index fine = A.upper_blocks();
  for (std::size_t l = 0; l < coarse_.size(); ++l) {
    CoarseMatrix& here = coarse_[l];
    const std::uint64_t items = static_cast<std::uint64_t>(here.items), limit = block_key(here.items, 0, here.items);
    Buffer<std::uint64_t> keys =
        l == 0 ? keys_of_parents(A.row.view(), A.col.view(), row_parent_.view(), here)
               : keys_of_parents(std::as_const(coarse_[l - 1].row).view(), std::as_const(coarse_[l - 1].col).view(), parent_.view(), here);
    if (within) {
      const std::uint64_t all = items * (items + 1) / 2, room = static_cast<std::uint64_t>(here.room.among(fine));
      group_within(std::move(keys), limit, static_cast<Index>(std::min(room, all)), here.terms, here.there, fetch);
    } else {
      group(std::move(keys), limit, here.terms);
      here.there = here.terms.groups;
    }
    shape(here);
  }
  fetch.now("schwarz levels");
  if (std::any_of(coarse_.begin(), coarse_.end(), [](const CoarseMatrix& m) { return m.there > m.terms.groups; })) return false;
  for (CoarseMatrix& m : coarse_) m.room.found(m.there, fine);
  return true;
}

void Schwarz::find_patterns(const BlockMatrix& A) {
  if (A.pattern == pattern_) return;
  pattern_ = A.pattern;
  const bool known = std::all_of(coarse_.begin(), coarse_.end(), [](const CoarseMatrix& m) { return m.room.known(); });
  if (!known || !group_levels(A, true)) group_levels(A, false);
}

void Schwarz::build(const BlockMatrix& A, View<const Vec3> position) {
  find_patterns(A);
  const View<const Index> row_parent = row_parent_.view(), row_slot = row_slot_.view(), parent = parent_.view(), slot = slot_.view();
  const View<const Index> start = member_start_.view(), member = member_.view();
  const View<const double> moves = row_moves_.view();
  const View<Vec3> row_place = row_place_.view(), row_arm = row_arm_.view(), centre = centre_.view(), arm = arm_.view();
  device::copy(row_place.p, position.p, static_cast<std::size_t>(position.n) * sizeof(Vec3));

  // Centres, level by level, then arms.
  for (std::size_t l = 0; l < coarse_.size(); ++l) {
    const Index first = coarse_[l].first;
    device::parallel_for("schwarz.centres", coarse_[l].items, [=] MORTISE_HD(Index k) {
      const Index i = first + k;
      Vec3 sum = Vec3::Zero();
      double count = 0;
      for (Index m = start[i]; m < start[i + 1]; ++m) {
        const double w = l == 0 ? moves[member[m]] : 1.0;
        sum += w * (l == 0 ? row_place[member[m]] : centre[member[m]]);
        count += w;
      }
      centre[i] = count > 0 ? Vec3(sum / count) : sum;
    });
  }
  device::parallel_for("schwarz.arms", row_arm.n, [=] MORTISE_HD(Index i) {
    row_arm[i] = row_parent[i] < 0 ? row_place[i] : Vec3(row_place[i] - moves[i] * centre[row_parent[i]]);
  });
  device::parallel_for("schwarz.arms", arm.n, [=] MORTISE_HD(Index i) { arm[i] = parent[i] < 0 ? centre[i] : Vec3(centre[i] - centre[parent[i]]); });

  domains_.lower.zero(), domains_.size.zero();
  fill_fine(A, row_slot, domains_);
  const View<Vec3> size = domains_.size.view();
  for (std::size_t l = 0; l < coarse_.size(); ++l) {
    CoarseMatrix& here = coarse_[l];
    const View<Mat6> value = here.value.view();
    if (l == 0) {
      const View<const Index> row = A.row.view(), col = A.col.view();
      const View<const Mat3> fine = A.value.view();
      grouped_sum<Mat6>(
          "schwarz.galerkin", here.terms,
          [=] MORTISE_HD(Index k) -> Mat6 {
            const Index i = row[k], j = col[k];
            return placed(row_term(fine[k], moves[i], row_arm[i], moves[j], row_arm[j]), i == j, row_parent[i], row_parent[j]);
          },
          [=] MORTISE_HD(Index k, const Mat6& t) { value[k] = t; });
    } else {
      const CoarseMatrix& below = coarse_[l - 1];
      const View<const Index> row = below.row.view(), col = below.col.view();
      const View<const Mat6> fine = below.value.view();
      grouped_sum<Mat6>(
          "schwarz.galerkin", here.terms,
          [=] MORTISE_HD(Index k) -> Mat6 {
            const Index i = row[k], j = col[k];
            return placed(item_term(fine[k], arm[i], arm[j]), i == j, parent[i], parent[j]);
          },
          [=] MORTISE_HD(Index k, const Mat6& t) { value[k] = t; });
    }
    fill_coarse(here, slot, domains_);
    const Index first = here.first;
    device::parallel_for("schwarz.sizes", here.items, [=] MORTISE_HD(Index k) {
      const Index i = first + k;
      Vec3 t = Vec3::Zero(), w = Vec3::Zero();
      for (Index m = start[i]; m < start[i + 1]; ++m) {
        const Index c = member[m];
        if (l == 0) {
          t += moves[c] * moves[c] * size[row_slot[c]], w += turned(size[row_slot[c]], row_arm[c]);
        } else {
          t += size[slot[c]], w += size[slot[c] + 1] + turned(size[slot[c]], arm[c]);
        }
      }
      size[slot[i]] = t, size[slot[i] + 1] = w;
    });
  }
  domains_.invert();
  const View<const Index> bad_domain = domains_.bad.view();
  const View<Index> bad = bad_.view();
  device::parallel_for("schwarz.bad", bad.n, [=] MORTISE_HD(Index i) { bad[i] = bad_domain[row_slot[i] / kSlots]; });
}

void Schwarz::apply(View<const Vec3> r, View<Vec3> z) const {
  const View<const Index> row_parent = row_parent_.view(), row_slot = row_slot_.view(), parent = parent_.view(), slot = slot_.view();
  const View<const Index> start = member_start_.view(), member = member_.view(), row_of_slot = row_of_slot_.view(), blocks = domains_.blocks.view();
  const View<const double> moves = row_moves_.view();
  const View<const Vec3> row_place = row_place_.view(), row_arm = row_arm_.view(), centre = centre_.view(), arm = arm_.view();
  const View<Vec3> restricted = restricted_.view(), half = half_.view(), solved = solved_.view();
  const View<const Mat3f> X = domains_.inverse.view();

  // Forces and moments on the items.
  for (std::size_t l = 0; l < coarse_.size(); ++l) {
    const Index first = coarse_[l].first;
    device::fold(
        "schwarz.restrict", coarse_[l].items,
        [=] MORTISE_HD(Index k, Index & from, Index & to) { from = start[first + k], to = start[first + k + 1]; },
        [=] MORTISE_HD(Index m) -> Vec6 {
          const Index c = member[m];
          Vec6 out;
          if (l == 0) {
            out << moves[c] * r[c], row_arm[c].cross(r[c]);
          } else {
            const Vec3 f = restricted[slot[c]];
            out << f, restricted[slot[c] + 1] + arm[c].cross(f);
          }
          return out;
        },
        device::AddUp<Vec6>(),
        [=] MORTISE_HD(Index k, const Vec6& sum) {
          const Index s = slot[first + k];
          restricted[s] = sum.head<3>(), restricted[s + 1] = sum.tail<3>();
        });
  }
  // Term (s, b) of slot s is number s kSlots + b.
  device::fold(
      "schwarz.forward", half.n,
      [=] MORTISE_HD(Index s, Index & from, Index & to) {
        const Index a = s % kSlots;
        from = s * kSlots, to = a < blocks[s / kSlots] ? from + a + 1 : from;
      },
      [=] MORTISE_HD(Index j) -> Vec3 {
        const Index s = j / kSlots, b = j % kSlots, d = s / kSlots, other = d * kSlots + b, row = row_of_slot[other];
        return X[d * kPacked + packed_place(s % kSlots, b)].cast<double>() * (row < 0 ? restricted[other] : r[row]);
      },
      device::AddUp<Vec3>(), [=] MORTISE_HD(Index s, const Vec3& y) { half[s] = y; });
  device::fold(
      "schwarz.backward", solved.n,
      [=] MORTISE_HD(Index s, Index & from, Index & to) {
        from = s * kSlots + s % kSlots, to = s * kSlots + blocks[s / kSlots];
        if (to < from) to = from;
      },
      [=] MORTISE_HD(Index j) -> Vec3 {
        const Index s = j / kSlots, b = j % kSlots, d = s / kSlots;
        return X[d * kPacked + packed_place(b, s % kSlots)].cast<double>().transpose() * half[d * kSlots + b];
      },
      device::AddUp<Vec3>(), [=] MORTISE_HD(Index s, const Vec3& y) { solved[s] = y; });
  // A row's own share, and its part in the motions of all items it belongs to.
  device::parallel_for("schwarz.prolong", z.n, [=] MORTISE_HD(Index i) {
    Vec3 sum = solved[row_slot[i]];
    for (Index p = row_parent[i]; p >= 0; p = parent[p])
      sum += moves[i] * solved[slot[p]] + solved[slot[p] + 1].cross(row_place[i] - moves[i] * centre[p]);
    z[i] = sum;
  });
}

}  // namespace mortise::linalg
