#include "linalg/grouping.h"

namespace mortise::linalg {

void group(Buffer<std::uint64_t>&& keys, std::uint64_t limit, Grouping& out) {
  const Index n = keys.size();
  out.term.resize(n);
  const View<Index> term = out.term.view();
  device::parallel_for("group.terms", n, [=] MORTISE_HD(Index i) { term[i] = i; });
  device::sort_pairs(keys, out.term);
  Buffer<Index> start;
  device::run_starts(keys, start, limit);
  const View<const std::uint64_t> key = keys.view();
  const View<const Index> s = start.view();
  const Index groups = start.size() - 1;
  out.groups = groups;
  out.key.resize(groups);
  out.group_chunks.resize(groups + 1);
  const View<std::uint64_t> group_key = out.key.view();
  const View<Index> gc = out.group_chunks.view();
  device::parallel_for("group.chunks", groups, [=] MORTISE_HD(Index k) {
    group_key[k] = key[s[k]];
    gc[k] = (s[k + 1] - s[k] + device::kChunk - 1) / device::kChunk;
  });
  device::scan(out.group_chunks);
  // How many chunks there are only the device knows: room for as many as there can be.
  out.chunk_start.resize(groups + n / device::kChunk + 1);
  const View<Index> cs = out.chunk_start.view();
  device::parallel_for("group.chunks", groups + 1, [=] MORTISE_HD(Index k) {
    if (k == groups)
      cs[gc[k]] = s[k];
    else
      for (Index c = gc[k]; c < gc[k + 1]; ++c) cs[c] = s[k] + (c - gc[k]) * device::kChunk;
  });
}

}  // namespace mortise::linalg
