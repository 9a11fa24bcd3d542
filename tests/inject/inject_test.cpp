// Every call of a short run that changes a file in its folder goes wrong once: killed before it, half-way through or after it, a disk that is
// full or broken. Whatever happens, `--resume=auto` gets to the state of the run that nothing disturbed, bit for bit.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>
#include <vector>

namespace fs = std::filesystem;

namespace mortise {
namespace {

// 4 steps, 3 frames and a checkpoint with each, contact and friction: a run of a tenth of a second.
constexpr const char* kScene = R"(mortise: 1
name: tiny
time: {step: 2 ms, steps: 4, frame_every: 2}
materials:
  gel: {youngs_modulus: 50 kPa, poisson_ratio: 0.4, density: 1050}
bodies:
  block: {type: soft, shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 10 mm}}, material: gel, position: [0, 0, 5.08 mm], velocity: [0.05, 0, -0.1]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  barrier_contact: {d_hat: 0.1 mm, stiffness: 10 kPa}
  friction: {mu: 0.3}
solver: {trace: true}
checks:
  - {quantity: kinetic_energy, when: always, below: 1 J}
  - {quantity: position, body: block, axis: x, when: end, above: -1 m}
)";

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

herr_t keep(hid_t root, const char* name, const H5O_info_t* info, void* out) {
  if (info->type != H5O_TYPE_DATASET || std::string(name).ends_with("/wall_ms")) return 0;
  const hid_t set = H5Dopen2(root, name, H5P_DEFAULT), type = H5Dget_type(set), space = H5Dget_space(set);
  if (H5Tget_class(type) != H5T_STRING) {
    std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    const bool read = values.empty() || H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0;
    std::string& bytes = (*static_cast<std::map<std::string, std::string>*>(out))[name];
    bytes = read ? std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)) : "unreadable";
  }
  H5Sclose(space), H5Tclose(type), H5Dclose(set);
  return 0;
}

// All numbers of fields.vtkhdf but the seconds that steps took, the log and the certificate: what is left of a run.
std::map<std::string, std::string> results(const std::string& dir) {
  static std::mutex hdf5;  // has no threads
  std::map<std::string, std::string> out;
  {
    const std::lock_guard<std::mutex> lock(hdf5);
    const hid_t file = H5Fopen((dir + "/fields.vtkhdf").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0) return {{"fields.vtkhdf", "cannot be opened"}};
    H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, keep, &out, H5O_INFO_BASIC);
    H5Fclose(file);
  }
  for (const char* name : {"newton.csv", "certificate.json", "fields.xdmf"}) out[name] = text_of(dir + "/" + name);
  return out;
}

std::string difference(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b) {
  for (const auto& [name, bytes] : a)
    if (const auto it = b.find(name); it == b.end() || it->second != bytes) return name;
  return a.size() == b.size() ? "" : "something more";
}

class Campaign : public testing::Test {
 protected:
  explicit Campaign(const std::string& scene = kScene) {
    setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
    // In memory where there is such a place: syncs cost nothing there.
    const fs::path place = access("/dev/shm", W_OK) == 0 ? fs::path("/dev/shm") : fs::temp_directory_path();
    base_ = (place / ("mortise_inject_" + std::to_string(getpid()))).string();
    fs::create_directories(base_);
    std::ofstream(base_ + "/tiny.yaml") << scene;
    EXPECT_EQ(run(base_ + "/whole", {"INJECT_COUNT=" + base_ + "/count"}), 0);
    calls_ = std::atol(text_of(base_ + "/count").c_str());
    whole_ = results(base_ + "/whole");
    EXPECT_GT(calls_, 60);
    EXPECT_GT(whole_.size(), 40u);
  }
  ~Campaign() override { fs::remove_all(base_); }

  // The exit code, or 128 + signal. `environment`: for the preloaded library; none: it is not loaded.
  int run(const std::string& dir, std::vector<std::string> environment, const std::string& log = "/dev/null") {
    const pid_t child = fork();
    if (child == 0) {
      if (!environment.empty()) {
        environment.push_back("INJECT_UNDER=" + dir);
        environment.push_back(std::string("LD_PRELOAD=") + MORTISE_INJECT);
        for (std::string& e : environment) putenv(e.data());
      }
      if (!freopen(log.c_str(), "w", stderr)) _exit(99);
      const std::string program = std::string(MORTISE_BINARY_DIR) + "/bin/mortise", scene = base_ + "/tiny.yaml";
      execl(program.c_str(), "mortise", "run", scene.c_str(), "-o", dir.c_str(), "--resume=auto", "--no-render", "-q", "-j", "1",
            static_cast<char*>(nullptr));
      _exit(98);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }

  // `what` happens to each call in turn; `fits`: may the run end with this code?
  template <class F>
  void disturb_every_call(const std::string& what, F fits) {
    std::atomic<long> next = 1, lost = 0;
    const auto work = [&] {
      for (long at = next++; at <= calls_; at = next++) {
        const std::string dir = base_ + "/" + what + std::to_string(at), log = dir + ".log",
                          name = what + " at call " + std::to_string(at) + " of " + std::to_string(calls_);
        const int code = run(dir, {"INJECT=" + what, "INJECT_AT=" + std::to_string(at)}, log);
        EXPECT_TRUE(fits(code)) << name << ": exit code " << code << "\n" << text_of(log);
        const int again = run(dir, {}, log);
        EXPECT_EQ(again, 0) << name << ", taken up again:\n" << text_of(log);
        const std::string differs = difference(whole_, results(dir));
        EXPECT_EQ(differs, "") << name;
        if (again != 0 || !differs.empty()) ++lost;
        for (const fs::directory_entry& left : fs::directory_iterator(dir)) {
          const std::string file = left.path().filename();
          EXPECT_TRUE(fs::exists(base_ + "/whole/" + file) || file.ends_with(".tmp")) << name << " leaves " << file;
        }
        fs::remove_all(dir);
      }
    };
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
    for (std::thread& t : threads) t.join();
    RecordProperty("calls", static_cast<int>(calls_));
    EXPECT_EQ(lost, 0) << "of " << calls_;
  }

  std::string base_;
  long calls_ = 0;
  std::map<std::string, std::string> whole_;
};

// 16 frames, a checkpoint with every fifth: most frames are behind the last checkpoint, and several share a commit.
class FewCheckpoints : public Campaign {
 protected:
  FewCheckpoints() : Campaign(few()) {}
  static std::string few() {
    std::string text = kScene;
    const std::string often = "steps: 4, frame_every: 2";
    return text.replace(text.find(often), often.size(), "steps: 16") + "output: {checkpoint_every: {steps: 5}}\n";
  }
};

constexpr auto killed = [](int code) { return code == 128 + SIGKILL; };
// Where nothing that counts was hit (removing a file that is of no use any more) the run may end well.
constexpr auto refused = [](int code) { return code == 0 || code == 6 || code == 75; };

TEST_F(Campaign, KilledBeforeEveryCall) { disturb_every_call("kill", killed); }
TEST_F(Campaign, KilledWithinEveryCall) { disturb_every_call("half", killed); }
TEST_F(FewCheckpoints, KilledBeforeEveryCall) { disturb_every_call("kill", killed); }
TEST_F(FewCheckpoints, KilledWithinEveryCall) { disturb_every_call("half", killed); }
TEST_F(FewCheckpoints, DiskFullFromEveryCallOn) { disturb_every_call("full", refused); }
TEST_F(Campaign, EveryCallFailsOnce) { disturb_every_call("EIO", refused); }
TEST_F(Campaign, DiskFullFromEveryCallOn) { disturb_every_call("full", refused); }
TEST_F(Campaign, EveryWriteIsShort) {
  disturb_every_call("short", [](int code) { return code == 0; });
}

}  // namespace
}  // namespace mortise
