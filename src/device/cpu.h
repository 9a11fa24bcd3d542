#pragma once
// CPU backend: a launch is a loop over oneTBB threads.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "device/trap.h"

namespace mortise::device {

// Kernels run on threads of the host.
inline constexpr bool kHostThreads = true;

template <class F>
void parallel_for(const char* name, Index n, F f) {
  if (n <= 0) return;
  count_launch(name);
  if (trap::on) {
    F seen = f;  // a copy, so that the address of f itself never leaves this function
    __builtin_clear_padding(&seen);
    trap::check_closure(name, &seen, sizeof seen);
  }
  const trap::Open open(name);
  constexpr Index kSerial = 64;  // below this a task costs more than the loop
  if (n <= kSerial) {
    for (Index i = 0; i < n; ++i) f(i);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<Index>(0, n, kSerial / 2), [&](const tbb::blocked_range<Index>& r) {
    for (Index i = r.begin(); i != r.end(); ++i) f(i);
  });
}

// put(k, ((start + term(from)) + term(from + 1)) + ...) for k = 0 .. n - 1, where segment(k, from, to) says what [from, to) is; `combine` has
// take(sum, term), which is +=, and start(). Terms of a segment may be found at the same time, in any order; they are added in theirs.
template <class Segment, class Term, class Combine, class Put>
void fold(const char* name, Index n, Segment segment, Term term, Combine combine, Put put) {
  parallel_for(name, n, [=](Index k) {
    Index i = 0, to = 0;
    segment(k, i, to);
    auto sum = combine.start();
    for (; i < to; ++i) combine.take(sum, term(i));
    put(k, sum);
  });
}

}  // namespace mortise::device
