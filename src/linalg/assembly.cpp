#include "linalg/assembly.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "device/runs.h"
#include "linalg/upper_block.h"

namespace mortise::linalg {
namespace {

void group_gradient(const StencilView& s, Index terms, Index blocks, Grouping& out) {
  Buffer<std::uint64_t> keys(terms);
  const View<std::uint64_t> key = keys.view();
  const View<const Index> block = s.block;
  device::parallel_for("assembly.grad_keys", terms,
                       [=] MORTISE_HD(Index i) { key[i] = static_cast<std::uint64_t>(block[i] < 0 ? blocks : block[i]); });
  group_within(std::move(keys), static_cast<std::uint64_t>(blocks), std::min(terms, blocks), out);
}

// The keys of all Hessian pieces, and how each enters.
Buffer<std::uint64_t> hessian_keys(const StencilView& view, View<const Index> row_of_block, Index rows, Buffer<std::uint8_t>& place) {
  const StencilView s = view;
  Buffer<std::uint64_t> keys(s.hess.n);
  place.resize(s.hess.n);
  const View<std::uint64_t> key = keys.view();
  const View<std::uint8_t> entry = place.view();
  const std::uint64_t limit = block_key(rows, 0, rows);
  device::parallel_for("assembly.hess_keys", s.n, [=] MORTISE_HD(Index i) {
    const Index nb = s.blocks(i), first = s.offset[i];
    Index e = s.hess_offset[i];
    for (Index a = 0; a < nb; ++a) {
      const Index block_a = s.block[first + a];
      const Index ra = block_a < 0 ? -1 : row_of_block[block_a];
      for (Index b = a; b < nb; ++b, ++e) {
        const Index block_b = s.block[first + b];
        const Index rb = block_b < 0 ? -1 : row_of_block[block_b];
        key[e] = ra < 0 || rb < 0 ? limit : ra <= rb ? block_key(ra, rb, rows) : block_key(rb, ra, rows);
        entry[e] = a != b && ra == rb ? both : ra > rb ? transposed : direct;
      }
    }
  });
  return keys;
}

}  // namespace

// Distinct keys of the diagonal and of all lists, those of `of[i]` of list i, and the place among them of every key: first of the diagonal ones, then
// of list after list.
struct Merge {
  Buffer<std::uint64_t> keys;
  Buffer<Index> order, runs, start;
  Index places = 0, n = 0;
  std::vector<double> differs{0};

  // `before`: distinct keys that it may lead to again.
  void begin(const std::vector<const Grouping*>& lists, const std::vector<device::Ranges>& of, Index rows, const Buffer<std::uint64_t>& before,
             device::Fetch& fetch) {
    Index total = rows;
    places = rows;
    for (const Grouping* g : lists) places += g->groups;
    for (const device::Ranges& r : of) total += r.size();
    keys.resize(total), order.resize(total);
    const View<std::uint64_t> key = keys.view();
    const View<Index> o = order.view();
    const std::uint64_t limit = block_key(rows, 0, rows);  // of room without a group
    device::parallel_for("assembly.merge", rows, [=] MORTISE_HD(Index i) {
      o[i] = i;
      key[i] = block_key(i, i, rows);
    });
    for (Index list = 0, at = rows, base = rows; list < static_cast<Index>(lists.size()); ++list) {
      const View<const std::uint64_t> from = lists[list]->key.view();
      Buffer<Index> memory;
      const device::Places group = of[list].places(memory);
      device::parallel_for("assembly.merge", of[list].size(), [=] MORTISE_HD(Index k) {
        const Index g = group(k);
        key[at + k] = from[g] < limit ? from[g] : limit, o[at + k] = base + g;
      });
      at += of[list].size(), base += lists[list]->groups;
    }
    device::sort_pairs(keys, order, std::bit_width(limit | 1));
    device::mark_runs(keys, runs, limit);
    device::start_runs(keys, runs, total, start, limit);
    device::empty_runs(runs, start);
    fetch.add_total(runs, n);
    compare(before, fetch);
  }
  void compare(const Buffer<std::uint64_t>& with, device::Fetch& fetch) {
    const View<const std::uint64_t> sorted = std::as_const(keys).view(), before = with.view();
    const View<const Index> s = std::as_const(start).view();
    device::env_max(
        "assembly.compare", {0, std::min(before.n, sorted.n)},
        [=] MORTISE_HD(Index k) { return s[k] == s[k + 1] || before[k] != sorted[s[k]] ? 1.0 : 0.0; }, device::EnvValues{differs, fetch});
  }
  // Once that is fetched: true when `distinct` holds the same as before.
  bool end(Buffer<std::uint64_t>& distinct, Buffer<Index>& place) const {
    const bool same = n == distinct.size() && differs[0] == 0;
    distinct.resize(n);
    place.resize(places);
    const View<const std::uint64_t> sorted = keys.view();
    const View<const Index> s = start.view(), from = order.view();
    const View<std::uint64_t> d = distinct.view();
    const View<Index> p = place.view();
    device::parallel_for("assembly.merge", n, [=] MORTISE_HD(Index k) {
      d[k] = sorted[s[k]];
      for (Index j = s[k]; j < s[k + 1]; ++j) p[from[j]] = k;
    });
    return same;
  }
};

namespace {

void add_gradient(const StencilView& s, const Grouping& groups, View<Vec3> g, const GroupsOf* only) {
  const View<const Vec3> piece = s.grad;
  const View<const std::uint64_t> block = groups.key.view();
  grouped_sum<Vec3>(
      "assembly.gradient", groups, [=] MORTISE_HD(Index e) -> Vec3 { return piece[e]; },
      [=] MORTISE_HD(Index k, const Vec3& t) { g[static_cast<Index>(block[k])] += t; }, only);
}

void add_hessian(const StencilView& s, const Grouping& groups, View<const std::uint8_t> entry, View<const Index> to, View<Mat3> value,
                 const GroupsOf* only) {
  const View<const Mat3> piece = s.hess;
  grouped_sum<Mat3>(
      "assembly.hessian", groups,
      [=] MORTISE_HD(Index e) -> Mat3 {
        if (entry[e] == direct) return piece[e];
        if (entry[e] == transposed) return piece[e].transpose();
        return piece[e] + piece[e].transpose();
      },
      [=] MORTISE_HD(Index k, const Mat3& t) { value[to[k]] += t; }, only);
}

}  // namespace

Assembler::Assembler() = default;
Assembler::~Assembler() = default;

void Assembler::set_rows(Buffer<Index>&& row_of_block, Index rows, std::vector<Index> env_rows) {
  row_of_block_ = std::move(row_of_block);
  env_rows_ = std::move(env_rows);
  rows_ = rows;
  for (auto& s : sorted_) s->has_hess = false, s->room = {};
  merge_valid_ = false;
  begun_.reset(), merge_.reset();
}

Assembler::Sorted& Assembler::sorted(const StencilSet* set) {
  for (auto& s : sorted_)
    if (s->set == set) return *s;
  sorted_.push_back(std::make_unique<Sorted>());
  sorted_.back()->set = set;
  return *sorted_.back();
}

void Assembler::gradient(std::span<StencilSet* const> sets, Index blocks, Buffer<Vec3>& g) {
  std::vector<std::uint64_t> first_key;
  if (some() && g.size() == blocks) {
    const device::Ranges blocks_of(*env_blocks_, *whose_);
    for (const device::Ranges::Part& p : blocks_of.parts())
      device::clear(g.view().p + p.begin, static_cast<std::size_t>(p.end - p.begin) * sizeof(Vec3));
  } else {
    g.resize(blocks);
    g.zero();
  }
  if (some()) first_key.assign(env_blocks_->begin(), env_blocks_->end());
  for (StencilSet* set : sets) {
    Sorted& s = sorted(set);
    const StencilView view = set->view();
    if (!s.has_grad || s.grad_version != set->version() || s.grad_blocks != blocks) {
      group_gradient(view, view.block.n, blocks, s.grad);
      s.has_grad = true, s.grad_version = set->version(), s.grad_blocks = blocks;
    }
    if (some()) {
      const GroupsOf only = groups_of(s.grad, first_key, *whose_);
      add_gradient(view, s.grad, g.view(), &only);
    } else {
      add_gradient(view, s.grad, g.view(), nullptr);
    }
  }
}

void Assembler::matrix(std::span<StencilSet* const> sets, BlockMatrix& A) {
  device::Fetch fetch;
  matrix(sets, A, fetch);
}

// Sorts those that changed. How many groups they have the host hears with the structure of the matrix, where there is a number of last time to go by;
// of the others it waits for all together.
bool Assembler::sort_hessians(std::span<StencilSet* const> sets, device::Fetch& fetch) {
  std::vector<SortedTerms> terms(sets.size());
  std::vector<std::size_t> unknown;
  bool changed = false;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    Sorted& s = sorted(sets[i]);
    if (s.has_hess && s.hess_version == sets[i]->version()) continue;
    changed = true;
    Buffer<std::uint64_t> keys = hessian_keys(sets[i]->view(), row_of_block_.view(), rows_, s.place);
    const std::uint64_t limit = block_key(rows_, 0, rows_);
    s.has_hess = s.room.known(), s.hess_version = sets[i]->version();
    if (const Index n = keys.size(); s.room.known())
      group_within(std::move(keys), limit, std::min(s.room.among(n), n), s.hess, s.there, fetch);
    else
      begin_group(std::move(keys), limit, s.hess, terms[i], fetch), unknown.push_back(i);
  }
  if (unknown.empty()) return changed;
  fetch.now("groups of pieces");
  for (std::size_t i : unknown) {
    Sorted& s = sorted(sets[i]);
    s.there = terms[i].groups;
    end_group(std::move(terms[i]), s.hess);
    s.has_hess = true;
  }
  return true;
}

// Where it was too small they are sorted once more, and their groups are counted first.
bool Assembler::had_room(std::span<StencilSet* const> sets) {
  bool all = true;
  for (StencilSet* set : sets) {
    Sorted& s = sorted(set);
    const bool whole = s.there <= s.hess.groups;
    s.has_hess = whole;
    s.room = {};
    if (whole) s.room.found(s.there, set->view().hess.n);
    all = all && whole;
  }
  return all;
}

void Assembler::begin_matrix(std::span<StencilSet* const> sets, device::Fetch& fetch) {
  if (begun_) begun({});  // nobody wanted that matrix
  if (!std::equal(sets.begin(), sets.end(), merged_.begin(), merged_.end())) merge_valid_ = false;
  begun_whose_ = some() ? *whose_ : std::vector<std::uint8_t>{};
  if (begun_whose_ != merged_whose_) merge_valid_ = false;
  if (sort_hessians(sets, fetch)) merge_valid_ = false;
  std::vector<std::uint64_t> first_key;
  for (Index row : env_rows_) first_key.push_back(block_key(row, 0, rows_));
  std::vector<const Grouping*> lists;
  std::vector<device::Ranges> of;
  only_.clear();
  for (StencilSet* set : sets) {
    lists.push_back(&sorted(set).hess);
    if (some()) only_.push_back(groups_of(*lists.back(), first_key, begun_whose_));
    of.push_back(some() ? only_.back().groups : device::Ranges{0, lists.back()->groups});
  }
  begun_.emplace(sets.begin(), sets.end());
  merge_.reset();
  if (merge_valid_) return;
  merge_ = std::make_unique<Merge>();
  merge_->begin(lists, of, rows_, keys_, fetch);
}

// What it has sorted is looked at even where the sets have changed since: of those that have not it is used again.
bool Assembler::begun(std::span<StencilSet* const> sets) {
  if (!begun_) return false;
  const std::vector<StencilSet*> of = *std::exchange(begun_, std::nullopt);
  bool same = std::equal(sets.begin(), sets.end(), of.begin(), of.end()) && begun_whose_ == (some() ? *whose_ : std::vector<std::uint8_t>{});
  for (StencilSet* set : of) same = same && sorted(set).hess_version == set->version();
  if (merge_ && !had_room(of)) same = false;
  return same;
}

void Assembler::matrix(std::span<StencilSet* const> sets, BlockMatrix& A, device::Fetch& fetch) {
  while (!begun(sets)) {
    begin_matrix(sets, fetch);
    if (merge_) fetch.now("matrix");
  }
  if (merge_) {
    if (!merge_->end(keys_, merge_place_) || A.rows != rows_) pattern_ = 0;
    merge_.reset();
    merged_whose_ = begun_whose_;
    merged_.assign(sets.begin(), sets.end());
    merge_valid_ = true;
  }
  if (pattern_ == 0 || A.pattern != pattern_) {
    set_pattern(keys_, rows_, A);
    pattern_ = A.pattern;
  }
  A.value.zero();
  Index base = rows_;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const Sorted& s = sorted(sets[i]);
    add_hessian(sets[i]->view(), s.hess, s.place.view(), {merge_place_.view().p + base, s.hess.groups}, A.value.view(), some() ? &only_[i] : nullptr);
    base += s.hess.groups;
  }
}

}  // namespace mortise::linalg
