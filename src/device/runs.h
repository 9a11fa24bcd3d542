#pragma once
// Runs of equal keys in pieces, for callers that need not know at once how many there are: the number is left on the device, to be brought with other
// numbers, or nobody asks for it.
#include "device/device.h"

namespace mortise::device {

// place[i + 1] > place[i] where a run begins at key i of n sorted ones; place[n] is the number of runs below `limit`.
void mark_runs(const Buffer<std::uint64_t>& sorted_keys, Buffer<Index>& place, std::uint64_t limit = kNoKey);
// start[k]: where run k begins; behind the last run stands its end. Runs behind the first `most` are left out.
void start_runs(const Buffer<std::uint64_t>& sorted_keys, const Buffer<Index>& place, Index most, Buffer<Index>& start, std::uint64_t limit = kNoKey);
// Makes the places of `start` behind the runs that there are runs without keys.
void empty_runs(const Buffer<Index>& place, Buffer<Index>& start);

}  // namespace mortise::device
