#pragma once
// Work on all supernodes, children before their parents or after them, on as many threads as there are. What a supernode is given never depends on
// the threads, only when and where it is worked on.
#include <tbb/task_group.h>

#include "linalg/cholesky/supernodes.h"
#include "linalg/cholesky/tuning.h"

namespace mortise::linalg::cholesky {

class Tree {
 public:
  explicit Tree(const Supernodes& t) : t_(t), share_(t.flops.back() / tuning::kShares) {}

  // f(s), after f of everything below s.
  template <class F>
  void up(const F& f) const {
    up(t_.count(), f);
  }
  // f(s), before f of anything below s.
  template <class F>
  void down(const F& f) const {
    down(t_.count(), f);
  }

 private:
  // Children of s, in parts: many small ones one after the other, by light(first, last), large ones by heavy(child).
  template <class Light, class Heavy>
  void share_out(Index s, const Light& light, const Heavy& heavy) const {
    tbb::task_group group;
    double sum = 0;
    Index from = t_.begin[s];
    const auto flush = [&](Index to) {
      if (to > from) group.run([&light, first = from, last = to] { light(first, last); });
      from = to, sum = 0;
    };
    for (Index k = t_.child_start[s]; k < t_.child_start[s + 1]; ++k) {
      const Index child = t_.child[k];
      if (t_.flops[child] > share_) {
        flush(t_.begin[child]);
        group.run([&heavy, child] { heavy(child); });
        from = child + 1;
      } else {
        sum += t_.flops[child];
        if (sum > share_) flush(child + 1);
      }
    }
    flush(s);
    group.wait();
  }

  template <class F>
  void up(Index s, const F& f) const {
    share_out(
        s,
        [&](Index first, Index last) {
          for (Index k = first; k < last; ++k) f(k);
        },
        [&](Index child) { up(child, f); });
    if (s < t_.count()) f(s);
  }

  template <class F>
  void down(Index s, const F& f) const {
    if (s < t_.count()) f(s);
    share_out(
        s,
        [&](Index first, Index last) {
          for (Index k = last; k-- > first;) f(k);
        },
        [&](Index child) { down(child, f); });
  }

  const Supernodes& t_;
  double share_;
};

}  // namespace mortise::linalg::cholesky
