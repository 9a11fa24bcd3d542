#pragma once
// Reductions of fixed shape over all environments at once; included by device.h. The host sends the environments' bounds (none
// for a single environment) and gets one value per environment back, however many terms there are.
#include <vector>

namespace mortise::device {

// The values of one level of the tree, by environment, and the chunks they are cut into.
struct Level {
  View<const Index> first, first_chunk;  // per environment, and the end; empty for a single environment,
  Index begin = 0, end = 0;              // whose values these are
  MORTISE_HD void chunk(Index c, Index& from, Index& to) const {
    Index last = end;
    if (first.n == 0) {
      from = begin + c * kChunk;
    } else {
      Index lo = 0, hi = first.n - 1;  // chunk c belongs to the last environment that starts at or before it
      while (hi - lo > 1) {
        const Index mid = (lo + hi) / 2;
        (first_chunk[mid] <= c ? lo : hi) = mid;
      }
      from = first[lo] + (c - first_chunk[lo]) * kChunk;
      last = first[lo + 1];
    }
    to = from + kChunk < last ? from + kChunk : last;
  }
};

// first[l] bounds the values of level l by environment, and chunk c of level l is value c of level l + 1. An environment
// without terms has one empty chunk. The last level has one value per environment.
inline std::vector<std::vector<Index>> reduction_levels(const std::vector<Index>& offset) {
  std::vector<std::vector<Index>> levels{offset};
  for (bool more = true; more;) {
    const std::vector<Index> below = levels.back();
    std::vector<Index> first{0};
    more = false;
    for (std::size_t e = 0; e + 1 < below.size(); ++e) {
      const Index n = below[e + 1] - below[e], chunks = n > kChunk ? (n + kChunk - 1) / kChunk : 1;
      first.push_back(first.back() + chunks);
      more = more || chunks > 1;
    }
    levels.push_back(std::move(first));
  }
  return levels;
}

template <class Combine, class F>
void env_reduce(const char* name, const std::vector<Index>& offset, F f, EnvValues out) {
  const Index envs = static_cast<Index>(offset.size()) - 1;
  if (envs < 1 || offset.back() <= offset.front()) return;
  const std::vector<std::vector<Index>> levels = reduction_levels(offset);
  Buffer<Index> bounds;
  if (envs > 1) {
    std::vector<Index> all;
    for (const std::vector<Index>& l : levels) all.insert(all.end(), l.begin(), l.end());
    bounds.upload(all);
  }
  Index total = 0;
  for (std::size_t l = 1; l < levels.size(); ++l) total += levels[l].back();
  Buffer<double> tree(total);
  View<double> below, here = tree.view();
  for (std::size_t l = 0; l + 1 < levels.size(); ++l) {
    Level level;
    level.begin = levels[l].front(), level.end = levels[l].back();
    if (envs > 1) {
      const Index* at = bounds.view().p + static_cast<std::size_t>(l) * (envs + 1);
      level.first = {at, envs + 1}, level.first_chunk = {at + envs + 1, envs + 1};
    }
    const Index chunks = levels[l + 1].back();
    here.n = chunks;
    if (l == 0) {
      parallel_for(name, chunks, [=] MORTISE_HD(Index c) {
        Index from, to;
        level.chunk(c, from, to);
        double s = Combine::kStart;
        for (Index i = from; i < to; ++i) s = Combine()(s, f(i));
        here[c] = s;
      });
    } else {
      parallel_for("reduce.tree", chunks, [=] MORTISE_HD(Index c) {
        Index from, to;
        level.chunk(c, from, to);
        double s = Combine::kStart;
        for (Index i = from; i < to; ++i) s = Combine()(s, below[i]);
        here[c] = s;
      });
    }
    below = here;
    here.p += chunks;
  }
  out.fetch.keep(std::move(tree));
  out.fetch.add(View<const double>(below), [&value = out.value](const std::vector<double>& result) {
    for (std::size_t e = 0; e < result.size(); ++e) value[e] = Combine()(value[e], result[e]);
  });
}

template <class Combine, class F>
void env_reduce(const char* name, const std::vector<Index>& offset, F f, std::vector<double>& out) {
  Fetch fetch;
  env_reduce<Combine>(name, offset, f, EnvValues{out, fetch});
  fetch.now();
}

}  // namespace mortise::device
