#include "output/checkpoint.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <thread>

#include "helpers.h"
#include "output/atomic_file.h"

namespace mortise::output {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using Arrays = std::map<std::string, std::vector<double>, std::less<>>;

Arrays state(double base) {
  return {{"q", ramp(300, base)},
          {"effects/inertia/velocity", {base, -0.0, 1.0 / 3, std::numeric_limits<double>::denorm_min(), 9007199254740991.0}},
          {"effects/friction/anchor", {}},
          {"time", {0.1 * base}}};
}

void write(const std::string& dir, std::int64_t step) {
  CheckpointWriter writer(dir, {"0.1.0", std::string(64, 'b'), step, step / 2, 0.1 * step});
  for (auto& [name, values] : state(step)) writer.io(name, const_cast<std::vector<double>&>(values));
  writer.commit();
}

void expect_bits(const Arrays& got, const Arrays& want) {
  ASSERT_EQ(got.size(), want.size());
  for (const auto& [name, values] : want) {
    ASSERT_TRUE(got.contains(name)) << name;
    const auto& g = got.find(name)->second;
    ASSERT_EQ(g.size(), values.size()) << name;
    EXPECT_TRUE(values.empty() || std::memcmp(g.data(), values.data(), 8 * values.size()) == 0) << name;
  }
}

TEST(Checkpoint, RoundTripIsBitExact) {
  Folder dir;
  EXPECT_FALSE(has_checkpoint(dir.path()));
  write(dir.path(), 8);
  EXPECT_TRUE(has_checkpoint(dir.path()));
  CheckpointReader reader(dir / "checkpoint.h5");
  EXPECT_TRUE(reader.loading());
  EXPECT_EQ(reader.info().step, 8);
  EXPECT_EQ(reader.info().frames, 4);
  EXPECT_EQ(reader.info().time, 0.1 * 8);
  EXPECT_EQ(reader.info().mortise_version, "0.1.0");
  EXPECT_EQ(reader.info().scene_sha256, std::string(64, 'b'));
  expect_bits(reader.arrays(), state(8));
  std::vector<double> q;
  reader.io("q", q);
  EXPECT_EQ(q, ramp(300, 8));
  double time = 0;
  reader.io("time", time);
  EXPECT_EQ(time, 0.1 * 8);
  EXPECT_THAT(file_error([&] { reader.io("nothing", q); }), HasSubstr("no 'nothing'"));
}

TEST(Checkpoint, EqualStatesGiveEqualFiles) {
  Folder a, b;
  write(a.path(), 3);
  write(b.path(), 3);
  EXPECT_EQ(read_file(a / "checkpoint.h5"), read_file(b / "checkpoint.h5"));
}

TEST(Checkpoint, IsPlainHdf5) {
  Folder dir;
  write(dir.path(), 2);
  const h5::File f(dir / "checkpoint.h5", h5::Mode::read);
  EXPECT_EQ(h5::get_text(f, f.id(), "filetype"), "mortise checkpoint");
  const h5::Table t = h5::Table::open(f, h5::open_group(f, f.id(), "state/effects/inertia"), "velocity");
  EXPECT_EQ(t.rows(), 5u);
}

TEST(Checkpoint, KeepsTheLastTwo) {
  Folder dir;
  for (int step : {1, 2, 3}) write(dir.path(), step);
  EXPECT_EQ(CheckpointReader(dir / "checkpoint.h5").info().step, 3);
  EXPECT_EQ(CheckpointReader(dir / "checkpoint.prev.h5").info().step, 2);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir.path()), {}), 2);
  const NewestCheckpoint found = open_newest_valid(dir.path());
  EXPECT_EQ(found.reader.info().step, 3);
  EXPECT_THAT(found.skipped, IsEmpty());
}

// Also while the next one is put in its place: whoever reads a folder, or kills a run, finds a checkpoint.
TEST(Checkpoint, IsThereAtAnyMoment) {
  Folder dir;
  write(dir.path(), 1);
  const std::string path = dir / "checkpoint.h5";
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (int step = 2; step < 200; ++step) write(dir.path(), step);
    done = true;
  });
  long missing = 0;
  while (!done) missing += ::access(path.c_str(), F_OK) != 0;
  writer.join();
  EXPECT_EQ(missing, 0);
  EXPECT_EQ(CheckpointReader(dir / "checkpoint.prev.h5").info().step, 198);
}

// Killed when the old one had its second name and the new one none yet.
TEST(Checkpoint, GoesOnAfterAKillBetweenItsNames) {
  Folder dir;
  write(dir.path(), 1);
  std::filesystem::create_hard_link(dir / "checkpoint.h5", dir / "checkpoint.prev.h5");
  write(dir.path(), 2);
  EXPECT_EQ(CheckpointReader(dir / "checkpoint.h5").info().step, 2);
  EXPECT_EQ(CheckpointReader(dir / "checkpoint.prev.h5").info().step, 1);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir.path()), {}), 2);
}

TEST(Checkpoint, EveryFlippedByteIsDetected) {
  Folder dir;
  write(dir.path(), 4);
  const std::string path = dir / "checkpoint.h5", good = read_file(path);
  std::mt19937 random(1);
  std::vector<std::size_t> places = {0, 8, good.size() / 2, good.size() - 1, good.size() - 20, good.size() - 86};
  for (int i = 0; i < 60; ++i) places.push_back(random() % good.size());
  for (const std::size_t at : places) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    write_file(path, bad, false);
    EXPECT_THAT(file_error([&] { CheckpointReader reader(path); }), HasSubstr(path)) << at;
  }
  write_file(path, good, false);
  EXPECT_EQ(CheckpointReader(path).info().step, 4);
}

TEST(Checkpoint, EveryTruncationIsDetected) {
  Folder dir;
  write(dir.path(), 4);
  const std::string path = dir / "checkpoint.h5", good = read_file(path);
  for (const std::size_t size : {std::size_t(0), std::size_t(1), std::size_t(85), good.size() / 2, good.size() - 85, good.size() - 1}) {
    write_file(path, good.substr(0, size), false);
    EXPECT_THAT(file_error([&] { CheckpointReader reader(path); }), HasSubstr("truncated")) << size;
  }
}

TEST(Checkpoint, FallsBackToThePreviousOne) {
  Folder dir;
  write(dir.path(), 1);
  write(dir.path(), 2);
  std::string bytes = read_file(dir / "checkpoint.h5");
  bytes[bytes.size() / 2] ^= 1;
  write_file(dir / "checkpoint.h5", bytes, false);
  const NewestCheckpoint found = open_newest_valid(dir.path());
  EXPECT_EQ(found.reader.info().step, 1);
  expect_bits(found.reader.arrays(), state(1));
  ASSERT_THAT(found.skipped, SizeIs(1));
  EXPECT_THAT(found.skipped[0], HasSubstr("checkpoint.h5: damaged"));
  std::filesystem::remove(dir / "checkpoint.h5");  // a file system without second names, killed between two renames
  EXPECT_EQ(open_newest_valid(dir.path()).reader.info().step, 1);
  write_file(dir / "checkpoint.prev.h5", "rubbish", false);
  const std::string message = file_error([&] { open_newest_valid(dir.path()); });
  EXPECT_THAT(message, HasSubstr("checkpoint.h5': No such file"));
  EXPECT_THAT(message, HasSubstr("checkpoint.prev.h5: not a whole checkpoint"));
}

TEST(Checkpoint, FailedWriteLeavesTheOldOnes) {
  Folder dir;
  write(dir.path(), 1);
  const int status = in_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit most{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &most);
    try {
      write(dir.path(), 2);
    } catch (const Error& error) {
      return error.code() == Exit::file && std::string(error.what()).find("cannot write: File too large") != std::string::npos ? 7 : 8;
    }
    return 9;
  });
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(open_newest_valid(dir.path()).reader.info().step, 1);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir.path()), {}), 1);
  EXPECT_THAT(file_error([&] { write(dir / "missing", 1); }), HasSubstr("No such file or directory"));
}

TEST(Checkpoint, AbandonedWriterLeavesNothing) {
  Folder dir;
  {
    CheckpointWriter writer(dir.path(), {});
    double x = 1;
    writer.io("x", x);
    EXPECT_THROW(writer.io("x", x), Error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

}  // namespace
}  // namespace mortise::output
