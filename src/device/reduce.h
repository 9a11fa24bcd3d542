#pragma once
// Reductions of fixed shape over many environments at once; included by device.h. The host sends the environments' bounds (none
// for a single environment) and gets one value per environment back, however many terms there are.
#include <vector>

namespace mortise::device {

// The values of one level of the tree, by environment, and the chunks they are cut into.
struct Level {
  View<const Index> first, last, first_chunk;  // per environment; empty for a single one,
  Index begin = 0, end = 0;                    // whose values these are
  MORTISE_HD void chunk(Index c, Index& from, Index& to) const {
    Index stop = end;
    if (first.n == 0) {
      from = begin + c * kChunk;
    } else {
      Index lo = 0, hi = first.n;  // chunk c belongs to the last environment that starts at or before it
      while (hi - lo > 1) {
        const Index mid = (lo + hi) / 2;
        (first_chunk[mid] <= c ? lo : hi) = mid;
      }
      from = first[lo] + (c - first_chunk[lo]) * kChunk;
      stop = last[lo];
    }
    to = from + kChunk < stop ? from + kChunk : stop;
  }
};

// Where the chunks of every environment begin, of the terms and of level after level, and how many there are; each of them is a value of the level
// above. The last level has one value per environment.
inline std::vector<std::vector<Index>> reduction_levels(const std::vector<Ranges::Part>& parts) {
  std::vector<std::vector<Index>> levels;
  for (bool more = true; more;) {
    std::vector<Index> first{0};
    more = false;
    for (std::size_t e = 0; e < parts.size(); ++e) {
      const Index n = levels.empty() ? parts[e].end - parts[e].begin : levels.back()[e + 1] - levels.back()[e];
      const Index chunks = (n + kChunk - 1) / kChunk;
      first.push_back(first.back() + chunks);
      more = more || chunks > 1;
    }
    levels.push_back(std::move(first));
  }
  return levels;
}

template <class Combine, class F>
void env_reduce(const char* name, const Ranges& over, F f, EnvValues out) {
  const std::vector<Ranges::Part>& parts = over.parts();
  const auto envs = static_cast<Index>(parts.size());
  if (envs == 0) return;
  const std::vector<std::vector<Index>> levels = reduction_levels(parts);
  Buffer<Index> bounds;  // first and last of every environment, then the levels
  if (envs > 1) {
    std::vector<Index> all;
    for (const Ranges::Part& p : parts) all.push_back(p.begin);
    for (const Ranges::Part& p : parts) all.push_back(p.end);
    for (const std::vector<Index>& l : levels) all.insert(all.end(), l.begin(), l.end());
    bounds.upload(all);
  }
  Index total = 0;
  for (const std::vector<Index>& l : levels) total += l.back();
  Buffer<double> tree(total);
  View<double> below, here = tree.view();
  for (std::size_t l = 0; l < levels.size(); ++l) {
    Level level;
    level.begin = l == 0 ? parts[0].begin : 0, level.end = l == 0 ? parts[0].end : levels[l - 1].back();
    if (envs > 1) {
      const auto level_at = [&](std::size_t k) { return bounds.view().p + 2 * envs + static_cast<Index>(k) * (envs + 1); };
      level.first = {l == 0 ? bounds.view().p : level_at(l - 1), envs};
      level.last = {l == 0 ? bounds.view().p + envs : level_at(l - 1) + 1, envs};
      level.first_chunk = {level_at(l), envs};
    }
    const Index chunks = levels[l].back();
    here.n = chunks;
    const auto chunk = [=] MORTISE_HD(Index c, Index & from, Index & to) { level.chunk(c, from, to); };
    const auto keep = [=] MORTISE_HD(Index c, double s) { here[c] = s; };
    if (l == 0)
      fold(name, chunks, chunk, f, Combine(), keep);
    else
      fold(
          "reduce.tree", chunks, chunk, [=] MORTISE_HD(Index i) { return below[i]; }, Combine(), keep);
    below = here;
    here.p += chunks;
  }
  out.fetch.keep(std::move(tree));
  out.fetch.add(View<const double>(below), [&value = out.value, parts](const std::vector<double>& result) {
    for (std::size_t e = 0; e < result.size(); ++e) value[parts[e].env] = Combine()(value[parts[e].env], result[e]);
  });
}

template <class Combine, class F>
void env_reduce(const char* name, const Ranges& over, F f, std::vector<double>& out) {
  Fetch fetch;
  env_reduce<Combine>(name, over, f, EnvValues{out, fetch});
  fetch.now();
}

}  // namespace mortise::device
