#include "output/chunk.h"

#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <new>

#include "output/tuning.h"

namespace mortise::output::h5 {
namespace {

struct Piece {
  std::vector<std::byte> bytes;
  uLong checksum = 0, length = 0;  // of what was deflated
};

std::vector<std::byte> shuffle(const Raw& raw) {
  const std::size_t n = raw.bytes.size() / raw.size;
  std::vector<std::byte> out(raw.bytes.size());
  for (std::size_t b = 0; b < raw.size; ++b)
    for (std::size_t i = 0; i < n; ++i) out[b * n + i] = raw.bytes[i * raw.size + b];
  return out;
}

Piece deflate(std::span<const std::byte> in, bool last) {
  z_stream z = {};
  // Negative: without the stream's head and checksum.
  if (deflateInit2(&z, tuning::kDeflate, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  const auto* from = reinterpret_cast<const Bytef*>(in.data());
  const auto length = static_cast<uInt>(in.size());
  constexpr std::size_t kFlush = 16;  // [byte] more than what a flush adds
  Piece out{std::vector<std::byte>(deflateBound(&z, length) + kFlush), adler32(adler32(0, nullptr, 0), from, length), length};
  z.next_in = const_cast<Bytef*>(from), z.avail_in = length;
  z.next_out = reinterpret_cast<Bytef*>(out.bytes.data()), z.avail_out = static_cast<uInt>(out.bytes.size());
  ::deflate(&z, last ? Z_FINISH : Z_SYNC_FLUSH);
  out.bytes.resize(out.bytes.size() - z.avail_out);
  deflateEnd(&z);
  return out;
}

std::vector<std::byte> join(std::span<const Piece> pieces) {
  std::vector<std::byte> out{std::byte{0x78}, std::byte{0x01}};  // deflate with a window of 32 KiB, at the fastest level
  uLong checksum = adler32(0, nullptr, 0);
  for (const Piece& piece : pieces) {
    out.insert(out.end(), piece.bytes.begin(), piece.bytes.end());
    checksum = adler32_combine(checksum, piece.checksum, static_cast<z_off_t>(piece.length));
  }
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::byte>(checksum >> shift & 0xff));
  return out;
}

// f(i) for i < n. One alone asks no threads: a copy of a process (base/child.h) has none.
template <class F>
void for_each(std::size_t n, const F& f) {
  if (n == 1) return f(0);
  tbb::parallel_for(std::size_t{0}, n, f, tbb::simple_partitioner());
}

}  // namespace

std::vector<std::vector<std::byte>> compress(std::span<const Raw> chunks) {
  std::vector<std::vector<std::byte>> shuffled(chunks.size());
  for_each(chunks.size(), [&](std::size_t c) { shuffled[c] = shuffle(chunks[c]); });
  std::vector<std::size_t> first{0}, chunk_of;  // pieces of every chunk
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    first.push_back(first.back() + std::max<std::size_t>(1, (shuffled[c].size() + tuning::kPiece - 1) / tuning::kPiece));
    chunk_of.resize(first.back(), c);
  }
  std::vector<Piece> pieces(first.back());
  for_each(pieces.size(), [&](std::size_t p) {
    const std::vector<std::byte>& all = shuffled[chunk_of[p]];
    const std::size_t begin = (p - first[chunk_of[p]]) * tuning::kPiece, end = std::min(all.size(), begin + tuning::kPiece);
    pieces[p] = deflate(std::span(all).subspan(begin, end - begin), end == all.size());
  });
  std::vector<std::vector<std::byte>> out(chunks.size());
  for (std::size_t c = 0; c < chunks.size(); ++c) out[c] = join(std::span(pieces).subspan(first[c], first[c + 1] - first[c]));
  return out;
}

}  // namespace mortise::output::h5
