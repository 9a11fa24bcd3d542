#pragma once
// Sums of terms with equal keys in a fixed order: terms are sorted by key (stable), each group is cut into chunks of
// device::kChunk terms, chunks are summed in order, then the chunks of a group in order. The bits of a group depend on its own
// terms only; a long group (an affine body under thousands of contacts) is spread over many threads.
#include "device/device.h"

namespace mortise::linalg {

using device::Buffer;
using device::View;

struct Grouping {
  Index groups = 0;            // or room for so many (group_within): those behind the last have no terms, and kNoKey for a key
  Buffer<std::uint64_t> key;   // of every group, ascending
  Buffer<Index> term;          // terms sorted by key
  Buffer<Index> chunk_start;   // places in `term`: chunks + 1, and room
  Buffer<Index> group_chunks;  // groups + 1, places in `chunk_start`; the last is the number of chunks
};

// The groups of some environments, and their chunks.
struct GroupsOf {
  device::Ranges groups, chunks;
};
// Of the environments of `whose`; first_key[e]: the least key that belongs to environment e, ascending, and one more that belongs to none.
GroupsOf groups_of(const Grouping& g, const std::vector<std::uint64_t>& first_key, const std::vector<std::uint8_t>& whose);

// Groups the terms 0..n-1 by keys[term]; keys >= limit are left out. Consumes `keys`.
void group(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Grouping& out);
// The first `most` groups; nobody waits for their number.
void group_within(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Index most, Grouping& out);
// And `there` becomes how many there would have been, once `fetch` is done.
void group_within(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Index most, Grouping& out, Index& there, device::Fetch& fetch);
// The same in two halves, between which `fetch` brings the number of groups.
struct SortedTerms {
  Buffer<std::uint64_t> key;
  Buffer<Index> place;  // device::mark_runs
  std::uint64_t limit = 0;
  Index groups = 0;
};
void begin_group(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Grouping& out, SortedTerms& sorted, device::Fetch& fetch);
void end_group(SortedTerms&& sorted, Grouping& out);

// add(group, sum of value(term)) for every group that has terms, or every one of `only`. T is a fixed-size Eigen type or a number.
template <class T, class Value, class Add>
void grouped_sum(const char* name, const Grouping& g, Value value, Add add, const GroupsOf* only = nullptr) {
  const Index room = g.chunk_start.size() - 1, groups = g.groups;
  if (groups == 0) return;
  Buffer<T> partial(room);
  const View<T> part = partial.view();
  const View<const Index> term = g.term.view(), cs = g.chunk_start.view(), gc = g.group_chunks.view();
  device::parallel_for(name, only ? only->chunks : device::Ranges{0, room}, [=] MORTISE_HD(Index c) {
    if (c >= gc[groups]) return;
    T t = value(term[cs[c]]);
    for (Index j = cs[c] + 1; j < cs[c + 1]; ++j) t += value(term[j]);
    part[c] = t;
  });
  device::parallel_for(name, only ? only->groups : device::Ranges{0, groups}, [=] MORTISE_HD(Index k) {
    if (gc[k] == gc[k + 1]) return;
    T t = part[gc[k]];
    for (Index c = gc[k] + 1; c < gc[k + 1]; ++c) t += part[c];
    add(k, t);
  });
}

}  // namespace mortise::linalg
