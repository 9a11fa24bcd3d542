// Runs that are disturbed: stopped and killed at random moments, damaged checkpoints, disks that are full or cannot be written.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "output/field_reader.h"
#include "process.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

struct Folder {
  std::string path = (fs::temp_directory_path() / ("mortise_interrupt_" + std::to_string(getpid()) + "_" + std::to_string(counter++))).string();
  ~Folder() {
    std::error_code ec;
    fs::permissions(path, fs::perms::owner_all, ec);
    fs::remove_all(path);
  }
  static inline int counter = 0;
};

// A short run of many steps with contact and friction.
const std::string kScene = kSource + "/scenes/first/03_incline_friction.yaml";
const std::vector<std::string> kRun{"run", kScene, "--no-render", "--quiet", "--set", "time.steps=120", "--set", "time.frame_every=4"};

std::string command(const std::string& more) {
  return "run " + kScene + " --no-render --quiet --set time.steps=120 --set time.frame_every=4 " + more;
}

// `file_limit` > 0: no file may grow beyond so many bytes, as if the disk were full.
pid_t start_silent(std::vector<std::string> args, rlim_t file_limit = 0) {
  return start(std::move(args), [file_limit] {
    if (file_limit > 0) {
      const rlimit limit{file_limit, file_limit};
      setrlimit(RLIMIT_FSIZE, &limit);
    }
    (void)!freopen("/dev/null", "w", stderr);
  });
}

// Flips one byte in the middle of a file, or cuts it there.
void damage(const std::string& path, bool cut) {
  std::string bytes = read_text(path);
  if (cut)
    bytes.resize(bytes.size() / 2);
  else
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace

// SIGKILL, SIGTERM, SIGINT and SIGUSR1 at random moments of one run, which is taken up again each time: at the end not a bit differs.
TEST(Interrupt, RandomMomentsCostNothingButTheRunningStep) {
  const Folder whole, broken;
  const int moments = std::getenv("MORTISE_MOMENTS") ? std::atoi(std::getenv("MORTISE_MOMENTS")) : 12;
  const std::string longer =
      "--set solver.trace=true --set time.steps=" + std::to_string(100 * moments) + " ";  // so that the last signal still finds it running
  ASSERT_EQ(mortise(command(longer + "-o " + whole.path)).code, 0);
  std::mt19937 random(7);
  int killed = 0;
  for (int i = 0; i < moments; ++i) {
    std::vector<std::string> args = kRun;
    args.insert(args.end(),
                {"--set", "solver.trace=true", "--set", "time.steps=" + std::to_string(100 * moments), "-o", broken.path, "--resume=auto"});
    const pid_t pid = start_silent(args);
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + random() % 180));
    const int signal = std::vector<int>{SIGKILL, SIGTERM, SIGINT, SIGUSR1}[i % 4];
    kill(pid, signal);
    if (signal == SIGUSR1) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      kill(pid, SIGKILL);
    }
    const int code = wait_for(pid);
    EXPECT_TRUE(code == 0 || code == 75 || code == 128 + SIGKILL || code == 128 + signal) << code << " after signal " << signal;
    killed += code != 0;
  }
  RecordProperty("killed", killed);
  EXPECT_GE(killed, moments / 2);
  const Result last = mortise(command(longer + "--resume=auto -o " + broken.path));
  ASSERT_EQ(last.code, 0) << last.err;
  EXPECT_EQ(unlike(broken.path, whole.path), "");
  const output::FieldReader a(broken.path + "/fields.vtkhdf"), b(whole.path + "/fields.vtkhdf");
  EXPECT_EQ(a.frames(), b.frames());
  EXPECT_EQ(read_text(broken.path + "/newton.csv"), read_text(whole.path + "/newton.csv"));  // without rows of steps that were broken off
}

TEST(Interrupt, DamagedCheckpointGivesWayToTheOneBefore) {
  for (const bool cut : {true, false}) {
    const Folder whole, out;
    ASSERT_EQ(mortise(command("-o " + whole.path + " --frames 6")).code, 0);
    ASSERT_EQ(mortise(command("-o " + out.path + " --frames 4")).code, 0);
    damage(out.path + "/checkpoint.h5", cut);
    const Result r = mortise("run " + kScene + " --no-render --set time.steps=120 --set time.frame_every=4 -o " + out.path + " --resume --frames 6");
    ASSERT_EQ(r.code, 0) << r.err;
    EXPECT_NE(r.err.find("checkpoint.h5"), std::string::npos) << "it says which file it passed over: " << r.err;
    EXPECT_EQ(unlike(out.path, whole.path), "");
  }
}

TEST(Interrupt, TwoDamagedCheckpointsAreAnError) {
  const Folder out;
  ASSERT_EQ(mortise(command("-o " + out.path + " --frames 4")).code, 0);
  damage(out.path + "/checkpoint.h5", true);
  damage(out.path + "/checkpoint.prev.h5", false);
  const Result r = mortise(command("-o " + out.path + " --resume --frames 6"));
  EXPECT_EQ(r.code, 6);
  EXPECT_NE(r.err.find("checkpoint"), std::string::npos) << r.err;
  EXPECT_EQ(output::FieldReader(out.path + "/fields.vtkhdf").frames(), 5) << "the frames before are untouched";
}

// A limit on the size of files behaves as a disk that is full: whatever was finished stays readable, and the run goes on when there is room.
TEST(Interrupt, FullDiskEndsWithExitCode6AndGoesOnLater) {
  const Folder whole, out;
  const std::string often = "--set time.frame_every=1 --set output.checkpoint_every.steps=1 ";
  ASSERT_EQ(mortise(command(often + "-o " + whole.path)).code, 0);
  const auto room = fs::file_size(whole.path + "/fields.vtkhdf") / 10 * 9;
  std::vector<std::string> args = kRun;
  args.insert(args.end(), {"--set", "time.frame_every=1", "--set", "output.checkpoint_every.steps=1", "-o", out.path});
  EXPECT_EQ(wait_for(start_silent(args, room)), 6);
  EXPECT_GT(output::FieldReader(out.path + "/fields.vtkhdf").frames(), 5);
  const Result r = mortise(command(often + "--resume -o " + out.path));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(unlike(out.path, whole.path), "");
}

TEST(Interrupt, OutputThatCannotBeWrittenIsExitCode6) {
  const Folder out;
  std::ofstream(out.path) << "a file, not a folder";
  EXPECT_EQ(mortise(command("-o " + out.path)).code, 6);
  EXPECT_EQ(mortise(command("-o " + out.path + "/below")).code, 6);
  fs::remove(out.path);
  EXPECT_EQ(mortise(command("-o /proc/mortise")).code, 6);
  if (geteuid() == 0) return;  // nothing is forbidden to root
  fs::create_directory(out.path);
  fs::permissions(out.path, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(mortise(command("-o " + out.path)).code, 6);
}

}  // namespace mortise::cli
