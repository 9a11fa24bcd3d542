#pragma once
// Figures of bodies from values of their blocks (or rows), all of one array at once: chunks of device::kChunk values in order, then the
// chunks of a body in order, so that they are the same on every device and for any number of bodies.
#include <vector>

#include "device/device.h"

namespace mortise::solver {

// Of one value, of a chunk, of a body. A value that is not a number wins, so that it is seen.
struct Part {
  double largest, far;  // largest
  double sum[3];

  MORTISE_HD void add(const Part& p) {
    largest = device::Larger()(largest, p.largest), far = device::Larger()(far, p.far);
    for (int k = 0; k < 3; ++k) sum[k] += p.sum[k];
  }
};

struct AddParts {
  MORTISE_HD static Part start() { return {}; }
  MORTISE_HD void take(Part& sum, const Part& b) const { sum.add(b); }
};

// How the values of all bodies are cut into chunks.
class Chunks {
 public:
  Chunks() = default;
  // offset[i]: first value of body i; one more at the end.
  explicit Chunks(const std::vector<Index>& offset) {
    std::vector<Index> first{0}, begin, end;
    for (std::size_t i = 0; i + 1 < offset.size(); ++i) {
      for (Index from = offset[i]; from < offset[i + 1]; from += device::kChunk)
        begin.push_back(from), end.push_back(from + device::kChunk < offset[i + 1] ? from + device::kChunk : offset[i + 1]);
      first.push_back(static_cast<Index>(begin.size()));
    }
    first_.upload(first), begin_.upload(begin), end_.upload(end);
  }

  // take(std::vector<Part>), one per body, once the fetch is done; of(i) is the part of value i.
  template <class F, class Receive>
  void reduce(const char* name, F of, device::Fetch& fetch, Receive receive) const {
    device::Buffer<Part> chunk(begin_.size()), body(first_.size() - 1);
    const device::View<Part> parts = chunk.view(), out = body.view();
    const device::View<const Index> first = first_.view(), begin = begin_.view(), end = end_.view();
    device::fold(
        name, begin.n, [=] MORTISE_HD(Index c, Index & from, Index & to) { from = begin[c], to = end[c]; }, of, AddParts(),
        [=] MORTISE_HD(Index c, const Part& sum) { parts[c] = sum; });
    device::fold(
        "solver.bodies", out.n, [=] MORTISE_HD(Index b, Index & from, Index & to) { from = first[b], to = first[b + 1]; },
        [=] MORTISE_HD(Index c) { return parts[c]; }, AddParts(), [=] MORTISE_HD(Index b, const Part& sum) { out[b] = sum; });
    fetch.add(device::View<const Part>(out), receive);
    fetch.keep(std::move(chunk));
    fetch.keep(std::move(body));
  }

 private:
  device::Buffer<Index> first_, begin_, end_;  // first chunk of every body; values of every chunk
};

}  // namespace mortise::solver
