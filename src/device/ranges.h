#pragma once
// Some parts of a list in which those of every environment lie together: what a kernel runs over, and a sum is taken of, where the other environments
// stand still. Included by device.h.
#include <vector>

namespace mortise::device {

// Place of the k-th of them in the list.
struct Places {
  View<const Index> first, before;  // per run of neighbours: where it begins, and how many there are before it; empty for a single run,
  Index begin = 0;                  // which begins here
  MORTISE_HD Index operator()(Index k) const {
    if (first.n == 0) return begin + k;
    Index lo = 0, hi = first.n;  // the last run that begins at or before k
    while (hi - lo > 1) {
      const Index mid = (lo + hi) / 2;
      (before[mid] <= k ? lo : hi) = mid;
    }
    return first[lo] + (k - before[lo]);
  }
};

class Ranges {
 public:
  struct Part {
    Index env, begin, end;
  };

  // Environment e has [offset[e], offset[e+1]); those that `whose` marks, or all where it is empty.
  Ranges(const std::vector<Index>& offset, const std::vector<std::uint8_t>& whose = {}) : environments_(static_cast<Index>(offset.size()) - 1) {
    for (Index e = 0; e < environments_; ++e)
      if ((whose.empty() || whose[e]) && offset[e] < offset[e + 1])
        parts_.push_back({e, offset[e], offset[e + 1]}), size_ += offset[e + 1] - offset[e];
  }
  Ranges(std::initializer_list<Index> offset) : Ranges(std::vector<Index>(offset)) {}
  Index environments() const { return environments_; }
  const std::vector<Part>& parts() const { return parts_; }  // those that have any
  Index size() const { return size_; }

  // `memory` has to live as long as what is returned is used.
  Places places(Buffer<Index>& memory) const {
    std::vector<Index> first, before;
    Index end = -1, count = 0;
    for (const Part& p : parts_) {
      if (p.begin != end) first.push_back(p.begin), before.push_back(count);
      end = p.end, count += p.end - p.begin;
    }
    Places out;
    const auto runs = static_cast<Index>(first.size());
    if (runs > 0) out.begin = first[0];
    if (runs < 2) return out;
    first.insert(first.end(), before.begin(), before.end());
    memory.upload(first);
    out.first = {memory.view().p, runs}, out.before = {memory.view().p + runs, runs};
    return out;
  }

 private:
  Index environments_ = 0, size_ = 0;
  std::vector<Part> parts_;
};

// f(i) for all i of `over`.
template <class F>
void parallel_for(const char* name, const Ranges& over, F f) {
  Buffer<Index> memory;
  const Places place = over.places(memory);
  parallel_for(name, over.size(), [=] MORTISE_HD(Index k) { f(place(k)); });
}

}  // namespace mortise::device
