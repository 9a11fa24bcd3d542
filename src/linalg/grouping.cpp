#include "linalg/grouping.h"

#include <utility>

#include "device/runs.h"

namespace mortise::linalg {
namespace {

void sort_terms(Buffer<std::uint64_t>& keys, Grouping& out) {
  const Index n = keys.size();
  out.term.resize(n);
  const View<Index> term = out.term.view();
  device::parallel_for("group.terms", n, [=] MORTISE_HD(Index i) { term[i] = i; });
  device::sort_pairs(keys, out.term);
}

// Group k has the places [start[k], start[k+1]) of the sorted terms.
void cut_into_chunks(const Buffer<std::uint64_t>& sorted_keys, const Buffer<Index>& start, Grouping& out) {
  const View<const std::uint64_t> key = sorted_keys.view();
  const View<const Index> s = start.view();
  const Index groups = start.size() - 1;
  out.groups = groups;
  out.key.resize(groups);
  out.group_chunks.resize(groups + 1);
  const View<std::uint64_t> group_key = out.key.view();
  const View<Index> gc = out.group_chunks.view();
  device::parallel_for("group.chunks", groups, [=] MORTISE_HD(Index k) {
    group_key[k] = s[k] < s[k + 1] ? key[s[k]] : std::uint64_t{device::kNoKey};
    gc[k] = (s[k + 1] - s[k] + device::kChunk - 1) / device::kChunk;
  });
  device::scan(out.group_chunks);
  // How many chunks there are only the device knows: room for as many as there can be.
  out.chunk_start.resize(groups + key.n / device::kChunk + 1);
  const View<Index> cs = out.chunk_start.view();
  device::parallel_for("group.chunks", groups + 1, [=] MORTISE_HD(Index k) {
    if (k == groups)
      cs[gc[k]] = s[k];
    else
      for (Index c = gc[k]; c < gc[k + 1]; ++c) cs[c] = s[k] + (c - gc[k]) * device::kChunk;
  });
}

// Returns what device::mark_runs() found.
Buffer<Index> cut_within(Buffer<std::uint64_t>& keys, std::uint64_t limit, Index most, Grouping& out) {
  sort_terms(keys, out);
  Buffer<Index> place, start;
  device::mark_runs(keys, place, limit);
  device::start_runs(keys, place, most, start, limit);
  device::empty_runs(place, start);
  cut_into_chunks(keys, start, out);
  return place;
}

}  // namespace

void group(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Grouping& out) {
  SortedTerms sorted;
  device::Fetch fetch;
  begin_group(std::move(keys), limit, out, sorted, fetch);
  fetch.now("groups");
  end_group(std::move(sorted), out);
}

void group_within(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Index most, Grouping& out) { cut_within(keys, limit, most, out); }

void group_within(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Index most, Grouping& out, Index& there, device::Fetch& fetch) {
  Buffer<Index> place = cut_within(keys, limit, most, out);
  fetch.add_total(place, there);
  fetch.keep(std::move(place));
}

void begin_group(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Grouping& out, SortedTerms& sorted, device::Fetch& fetch) {
  sorted.key = std::move(keys), sorted.limit = limit;
  sort_terms(sorted.key, out);
  device::mark_runs(sorted.key, sorted.place, limit);
  fetch.add_total(sorted.place, sorted.groups);
}

void end_group(SortedTerms&& sorted, Grouping& out) {
  Buffer<Index> start;
  device::start_runs(sorted.key, sorted.place, sorted.groups, start, sorted.limit);
  cut_into_chunks(sorted.key, start, out);
  sorted = {};
}

GroupsOf groups_of(const Grouping& g, const std::vector<std::uint64_t>& first_key, const std::vector<std::uint8_t>& whose) {
  const auto n = static_cast<Index>(first_key.size());
  const Buffer<std::uint64_t> first(first_key);
  Buffer<Index> bounds(2 * n);
  const View<const std::uint64_t> wanted = first.view(), key = g.key.view();
  const View<const Index> chunks = g.group_chunks.view();
  const View<Index> out = bounds.view();
  const Index groups = g.groups;
  device::parallel_for("group.environments", n, [=] MORTISE_HD(Index e) {
    Index lo = 0, hi = groups;  // the first group whose key is not below
    while (lo < hi) {
      const Index mid = (lo + hi) / 2;
      if (key[mid] < wanted[e])
        lo = mid + 1;
      else
        hi = mid;
    }
    out[e] = lo, out[n + e] = groups > 0 ? chunks[lo] : 0;
  });
  const std::vector<Index> at = bounds.download();
  return {{{at.begin(), at.begin() + n}, whose}, {{at.begin() + n, at.end()}, whose}};
}

}  // namespace mortise::linalg
