#include "effects/mortar_contact/node_entries.h"

#include <utility>

namespace mortise::effects::mortar {

void merge(Buffer<std::uint64_t>& keys, Index nodes, Buffer<Index>& order, Buffer<Index>& start, Buffer<Index>& offset, Buffer<Index>& block) {
  device::sort_pairs(keys, order);
  device::run_starts(keys, start);
  const Index entries = start.size() - 1;
  block.resize(entries), offset.resize(nodes + 1);
  const View<const std::uint64_t> k = std::as_const(keys).view();
  const View<const Index> first = std::as_const(start).view();
  const View<Index> of = block.view(), at = offset.view();
  device::parallel_for("mortar_contact.entry_blocks", entries, [=] MORTISE_HD(Index e) { of[e] = static_cast<Index>(k[first[e]] & 0xffffffffull); });
  device::parallel_for("mortar_contact.node_offsets", nodes + 1, [=] MORTISE_HD(Index i) {
    Index lo = 0, hi = entries;  // first entry of a node >= i
    while (lo < hi) {
      const Index mid = (lo + hi) / 2;
      if (high(k[first[mid]]) < i)
        lo = mid + 1;
      else
        hi = mid;
    }
    at[i] = lo;
  });
}

}  // namespace mortise::effects::mortar
