#include "output/chunk.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "output/h5.h"
#include "output/tuning.h"

namespace mortise::output::h5 {
namespace {

std::vector<double> waves(std::size_t n) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(std::sin(0.01 * static_cast<double>(i)) + 1e-3 * static_cast<double>(i * 2654435761u % 1000));
  return out;
}

// HDF5 reads chunks of any size as if it had made them: of less than a piece, of whole pieces, of more, and in both precisions.
TEST(Chunk, IsWhatTheFiltersUndo) {
  for (const hid_t type : {H5T_IEEE_F32LE, H5T_IEEE_F64LE})
    for (const std::size_t bytes : {std::size_t{8}, std::size_t{1000}, tuning::kPiece, tuning::kPiece + 8, 3 * tuning::kPiece - 8}) {
      const File file = File::in_memory("chunks");
      const std::size_t rows = bytes / H5Tget_size(type);
      Table table = Table::create(file, file.id(), "t", {.type = type, .chunk_rows = rows, .compress = true});
      ASSERT_EQ(table.whole(), rows);
      const std::vector<double> values = waves(2 * rows);
      const std::vector<Raw> raw{table.raw(std::span(values).first(rows)), table.raw(std::span(values).last(rows))};
      const auto chunks = compress(raw);
      ASSERT_EQ(chunks.size(), 2u);
      table.write_chunk(file, rows, chunks[1]);
      table.write_chunk(file, 0, chunks[0]);
      const std::vector<double> back = table.read<double>(file, 0, 2 * rows);
      ASSERT_EQ(back.size(), values.size());
      for (std::size_t i = 0; i < back.size(); ++i)
        ASSERT_EQ(back[i], table.single() ? static_cast<float>(values[i]) : values[i]) << i << " of " << bytes << " bytes";
    }
}

TEST(Chunk, HasTheSameBytesForAnyNumberOfThreads) {
  const std::vector<double> values = waves(100'000);
  const auto bytes = std::as_bytes(std::span(values));
  const std::vector<Raw> raw(3, Raw{{bytes.begin(), bytes.end()}, sizeof(double)});
  const auto all = compress(raw);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(compress(raw), all);
}

// Others are written as HDF5 likes to.
TEST(Chunk, IsForTablesWithItsFiltersOnly) {
  const File file = File::in_memory("plain");
  EXPECT_EQ(Table::create(file, file.id(), "t", {.type = H5T_IEEE_F32LE, .chunk_rows = 5}).whole(), 0u);
  EXPECT_EQ(Table::open(file, file.id(), "t").whole(), 0u);
  Table::create(file, file.id(), "c", {.type = H5T_IEEE_F32LE, .components = 3, .chunk_rows = 5, .compress = true});
  EXPECT_EQ(Table::open(file, file.id(), "c").whole(), 5u);
}

}  // namespace
}  // namespace mortise::output::h5
