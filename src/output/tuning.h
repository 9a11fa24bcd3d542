#pragma once
// Every number of this folder that was chosen, with its reason.
#include <cstddef>
#include <cstdint>

namespace mortise::output::tuning {

// ---- field files (field_file.h)
inline constexpr int kFilesAtRest = 8;                 // as many keep their datasets open: from there on HDF5's walks through all of them cost more
                                                       // than opening some thirty again for every frame does (some milliseconds)
inline constexpr std::uintmax_t kSlowDisk = 50 << 20;  // [byte/s]: how long a damaged file may take to be tried

// ---- writing (chunk.h, paged_file.h)
inline constexpr int kDeflate = 1;                 // level: the fastest, as frames are written while the solver waits
inline constexpr std::size_t kPiece = 128 << 10;   // [byte] of a chunk that are deflated together: some milliseconds, and four windows of deflate
inline constexpr std::size_t kWaiting = 64 << 20;  // [byte] of fields that wait to be compressed together: more would only take memory
inline constexpr std::uint64_t kLong = 64 * 1024;  // [byte]: longer writes go to the disk at once, so that a frame need not fit into memory twice
inline constexpr std::uint64_t kRun = 1 << 20;     // [byte]: written by one call at most when pages are put together

// ---- columns of other programs' files (column_file.h)
inline constexpr std::size_t kMostRows = 1'000'000;  // keys of a scene; a day at 10 Hz
inline constexpr std::size_t kMostNamed = 12;        // datasets that a message lists

}  // namespace mortise::output::tuning
