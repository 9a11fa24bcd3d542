#pragma once
// Chunks of compressed tables (h5.h) as they stand in the file. HDF5's filters make them on one thread, one after the other; here those of a frame
// are made on all threads, with the same bytes for any number of them.
//
// A chunk is a zlib stream (RFC 1950, 1951) of the shuffled rows: the first bytes of all numbers, the second bytes of all and so on. It is deflated
// in pieces that know nothing of each other, each but the last brought to a whole byte by an empty stored block ("sync flush").
#include <cstddef>
#include <span>
#include <vector>

namespace mortise::output::h5 {

struct Raw {
  std::vector<std::byte> bytes;  // rows as they are stored
  std::size_t size;              // of a number
};
std::vector<std::vector<std::byte>> compress(std::span<const Raw> chunks);

}  // namespace mortise::output::h5
