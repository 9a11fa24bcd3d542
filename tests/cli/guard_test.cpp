// What must not slip through: other people's files, other runs, input that is made to break the program, output that nobody reads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "output/field_reader.h"
#include "process.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kHead = R"(mortise: 1
name: guard
time: {step: 2 ms, steps: 4, frame_every: 2}
materials:
  gel: {youngs_modulus: 50 kPa, poisson_ratio: 0.4, density: 1000}
)";
constexpr const char* kBlock =
    "  block: {type: soft, shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 10 mm}}, material: gel, position: [0, 0, 5.08 mm], velocity: [0, "
    "0, -0.1]}\n  floor: {type: half_space}\n";
constexpr const char* kEffects = "effects:\n  inertia: {}\n  gravity: {}\n  elasticity: {}\n  barrier_contact: {d_hat: 0.1 mm, stiffness: 10 kPa}\n";

class Guard : public testing::Test {
 protected:
  Guard() {
    fs::create_directories(dir_);
    write("a.yaml", std::string(kHead) + "bodies:\n" + kBlock + kEffects);
  }
  ~Guard() override { fs::remove_all(dir_); }
  std::string at(const std::string& name) const { return dir_ + "/" + name; }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(at(name)).parent_path());
    std::ofstream(at(name), std::ios::binary) << text;
  }
  Result run(const std::string& more, const std::string& before = "") const {
    return mortise("run " + at("a.yaml") + " --no-render -j 1 -o " + at("out") + " " + more, kSource, before);
  }
  std::string stiff_scene(const std::string& mesh, const std::string& more = "") const {
    return std::string(kHead) + "bodies:\n  b: {type: stiff, shape: {mesh: {file: " + mesh + "}}, material: gel, position: [0, 0, 2]" + more +
           "}\neffects: {inertia: {}, gravity: {}, affine_body: {}}\n";
  }
  const std::string dir_ = (fs::temp_directory_path() / ("mortise_guard_" + std::to_string(getpid()))).string();
};

std::string cube(double side, bool inner = false, bool outward = false) {
  std::string out;
  int first = 1;
  for (const double s : inner ? std::vector<double>{side, side / 2} : std::vector<double>{side}) {
    for (int i = 0; i < 8; ++i)
      for (int k = 0; k < 3; ++k) out += (k == 0 ? "v " : " ") + std::to_string((i >> k & 1 ? 0.5 : -0.5) * s) + (k == 2 ? "\n" : "");
    for (const std::array<int, 3>& f : std::vector<std::array<int, 3>>{
             {0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}}) {
      const bool turned = first > 1 && !outward;
      out += "f " + std::to_string(f[0] + first) + " " + std::to_string(f[turned ? 2 : 1] + first) + " " + std::to_string(f[turned ? 1 : 2] + first) +
             "\n";
    }
    first += 8;
  }
  return out;
}

double seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

TEST_F(Guard, ProgramsAreHardened) {
  if (std::system("readelf --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no readelf";
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizers' build has checks of its own";
#endif
  std::vector<std::string> files{kProgram};
  for (const auto& entry : fs::directory_iterator(std::string(MORTISE_BINARY_DIR) + "/bin")) files.push_back(entry.path());
  if (fs::exists(std::string(MORTISE_BINARY_DIR) + "/lib/libmortise_render.so"))
    files.push_back(std::string(MORTISE_BINARY_DIR) + "/lib/libmortise_render.so");
  for (const std::string& file : files) {
    const std::string seen = at("readelf");
    ASSERT_EQ(std::system(("readelf -dlhW " + quoted(file) + " >" + seen + " 2>&1").c_str()), 0);
    const std::string text = read_text(seen);
    EXPECT_THAT(text, HasSubstr("DYN (")) << file << ": position-independent";
    EXPECT_THAT(text, HasSubstr("GNU_RELRO")) << file;
    EXPECT_THAT(text, testing::ContainsRegex("BIND_NOW|Flags: NOW")) << file;
    EXPECT_THAT(text, testing::ContainsRegex("GNU_STACK .* RW ")) << file;
    if (const auto path = text.find("path: ["); path != std::string::npos) {
      const std::string list = ":" + text.substr(path + 7, text.find(']', path) - path - 7) + ":";
      EXPECT_THAT(list, Not(HasSubstr("::"))) << file << ": an empty element is the current folder";
      for (std::size_t i = 0; i + 1 < list.size(); i = list.find(':', i + 1))
        EXPECT_TRUE(list[i + 1] == '/' || list.compare(i + 1, 7, "$ORIGIN") == 0) << file << ": " << list;
    }
  }
  (void)!std::system(("readelf -sW --dyn-syms " + quoted(kProgram) + " >" + at("symbols") + " 2>&1").c_str());
  EXPECT_THAT(read_text(at("symbols")), HasSubstr("__stack_chk_fail"));
  EXPECT_THAT(read_text(at("symbols")), testing::ContainsRegex("__[a-z]+_chk@"));
}

TEST_F(Guard, FailedChecksHaveTheirOwnExitCodeAlsoWhenResumed) {
  write("a.yaml", read_text(at("a.yaml")) + "checks:\n  - {quantity: kinetic_energy, when: start, below: 1e-12 J}\n");
  const auto quiet = run("--frames 1 -q");
  EXPECT_EQ(quiet.code, 7);
  EXPECT_EQ(quiet.err.find("check failed: "), 0u) << quiet.err << "that much is said";
  const auto part = nlohmann::json::parse(read_text(at("out/run.json")));
  EXPECT_EQ(part["status"], "done");
  EXPECT_EQ(part["exit_code"], 7);
  EXPECT_EQ(run("--resume -q").code, 7) << "the first state counts in the continued run as well";
  const auto whole = nlohmann::json::parse(read_text(at("out/certificate.json")));
  EXPECT_EQ(whole["solver"]["steps"], 4);
  EXPECT_EQ(nlohmann::json::parse(read_text(at("out/run.json")))["steps"]["count"], 4);
  const std::string before = read_text(at("out/certificate.json"));
  const Result again = run("--resume");
  EXPECT_EQ(again.code, 7);
  EXPECT_THAT(again.err, HasSubstr("is finished: there is nothing to continue"));
  EXPECT_EQ(read_text(at("out/certificate.json")), before);
}

TEST_F(Guard, TwoRunsDoNotMeet) {
  const pid_t first = start({"run", at("a.yaml"), "--no-render", "-q", "-j", "1", "--set", "time.steps=1000000", "-o", at("out")});
  for (int i = 0; i < 200 && !fs::exists(at("out/checkpoint.h5")); ++i) usleep(50000);
  for (const char* how : {"--overwrite", "--resume=auto", "--resume"}) {
    const Result second = run(how);
    EXPECT_EQ(second.code, 6);
    EXPECT_THAT(second.err, HasSubstr("is in use by process " + std::to_string(first)));
  }
  kill(first, SIGKILL);
  wait_for(first);
  ASSERT_TRUE(fs::exists(at("out/run.lock")));
  const Result third = run("--overwrite");
  EXPECT_EQ(third.code, 0) << third.err;
  EXPECT_THAT(third.err, HasSubstr("taking over"));
  EXPECT_FALSE(fs::exists(at("out/run.lock")));
  write("out/run.lock", "elsewhere 17\n");
  EXPECT_THAT(run("--overwrite").err, HasSubstr("is in use by process 17 on elsewhere"));
}

TEST_F(Guard, OnlyOurOwnFilesGo) {
  ASSERT_EQ(run("-q").code, 0);
  write("out/frames/mine.png", "a picture of a cat");
  write("out/notes.txt", "mine");
  write("precious", "precious");
  for (const char* planted : {"run.json", "fields.vtkhdf.new", "run.json.tmp", "newton.csv"}) {
    fs::remove(at(std::string("out/") + planted));
    fs::create_symlink(at("precious"), at(std::string("out/") + planted));
  }
  const Result r = run("--overwrite -q");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(read_text(at("out/frames/mine.png")), "a picture of a cat");
  EXPECT_EQ(read_text(at("out/notes.txt")), "mine");
  EXPECT_EQ(read_text(at("precious")), "precious");
  fs::remove(at("out/fields.vtkhdf"));
  fs::create_symlink(at("precious"), at("out/fields.vtkhdf"));
  fs::remove(at("out/run.json"));
  EXPECT_EQ(run("--resume -q").code, 6);
  EXPECT_EQ(read_text(at("precious")), "precious");
}

// A run.json of another program was replaced.
TEST_F(Guard, FilesOfOurNamesThatAreNotOursStay) {
  for (const char* name : {"run.json", "fields.xdmf", "certificate.json", "checkpoint.h5"}) {
    fs::remove_all(at("out"));
    write(std::string("out/") + name, "{\"of\": \"another program\"}");
    const Result r = run("--overwrite -q");
    EXPECT_EQ(r.code, 6);
    EXPECT_THAT(r.err, HasSubstr(std::string(name) + "' was not written by mortise and is left alone"));
    EXPECT_EQ(read_text(at(std::string("out/") + name)), "{\"of\": \"another program\"}");
  }
}

// All of them went to out/scene.
TEST_F(Guard, ScenesWithoutANameGoToFoldersOfTheirFiles) {
  std::string text = read_text(at("a.yaml"));
  text.erase(text.find("name: guard\n"), 12);
  for (const char* file : {"one.yaml", "two.yaml"}) {
    write(file, text);
    EXPECT_EQ(mortise("run " + at(file) + " --no-render -q", dir_).code, 0);
  }
  EXPECT_TRUE(fs::exists(at("out/one/run.json")));
  EXPECT_TRUE(fs::exists(at("out/two/run.json")));
}

TEST_F(Guard, FieldsWithoutACheckpointAreNotStartedAfresh) {
  ASSERT_EQ(run("-q").code, 0);
  fs::remove(at("out/checkpoint.h5")), fs::remove(at("out/checkpoint.prev.h5"));
  const Result r = run("--resume=auto");
  EXPECT_EQ(r.code, 6);
  EXPECT_THAT(r.err, HasSubstr("holds 3 frames, but there is no checkpoint"));
  EXPECT_EQ(output::FieldReader(at("out/fields.vtkhdf")).frames(), 3);
}

TEST_F(Guard, ASceneIsWhatIsInItsFilesNotWhereTheyLie) {
  write("one/cube.obj", cube(1)), write("two/cube.obj", cube(1)), write("three/cube.obj", cube(1.02));
  for (const char* place : {"one", "two", "three"}) write(std::string(place) + "/s.yaml", stiff_scene("cube.obj"));
  const auto go = [&](const std::string& place, const std::string& how) {
    return mortise("run " + at(place + "/s.yaml") + " --no-render -q -o " + at("out") + " " + how);
  };
  ASSERT_EQ(go("one", "--frames 1").code, 0);
  const Result other = go("three", "--resume");
  EXPECT_EQ(other.code, 6);
  EXPECT_THAT(other.err, HasSubstr("belongs to another scene: a file that it names is another one"));
  EXPECT_EQ(nlohmann::json::parse(read_text(at("out/run.json")))["status"], "done") << "and the results are as they were";
  EXPECT_EQ(go("two", "--resume").code, 0);
}

TEST_F(Guard, DamagedFieldsAreAnError) {
  ASSERT_EQ(run("-q --frames 1").code, 0);
  const std::string whole = read_text(at("out/fields.vtkhdf"));
  std::mt19937 random(3);
  for (int trial = 0; trial < 6; ++trial) {
    std::string bytes = whole;
    for (int i = 0; i < 400; ++i) bytes[2000 + random() % 60000] = static_cast<char>(random());
    write("out/fields.vtkhdf", bytes);
    Result r;
    EXPECT_LT(seconds([&] { r = run("--resume -q"); }), 40);
    EXPECT_EQ(r.code, 6) << r.err;
    EXPECT_THAT(r.err, HasSubstr("fields.vtkhdf"));
  }
}

TEST_F(Guard, OutputThatNobodyReads) {
  const auto code = [&](const std::string& rest) {
    return WEXITSTATUS(std::system(
        ("bash -c " + quoted(quoted(kProgram) + " run " + at("a.yaml") + " --overwrite --no-render --json -o " + at("out") + rest) + " 2>/dev/null")
            .c_str()));
  };
  for (const char* rest : {" >/dev/full", " | true; exit ${PIPESTATUS[0]}"}) {
    EXPECT_EQ(code(rest), 6) << rest;
    EXPECT_EQ(nlohmann::json::parse(read_text(at("out/run.json")))["status"], "done") << rest;
    fs::remove(at("out/run.json"));
  }
  EXPECT_EQ(mortise("run " + at("a.yaml") + " --no-render --json -o " + quoted(at("o\xff"))).code, 0);
}

TEST_F(Guard, InputThatIsNoFile) {
  ASSERT_EQ(mkfifo(at("pipe.obj").c_str(), 0600), 0);
  const auto refused = [&](const std::string& text, const std::string& says) {
    write("s.yaml", text);
    Result r;
    EXPECT_LT(seconds([&] { r = mortise("check " + at("s.yaml")); }), 20) << says;
    EXPECT_TRUE(r.code == 3 || r.code == 6) << r.code << r.err;
    EXPECT_THAT(r.err, HasSubstr(says));
  };
  const std::string picture = "\nrender: {width: 64, height: 48, cameras: {c: {position: [1, 1, 1], look_at: [0, 0, 0]}}}\n";
  write("cube.obj", cube(1));
  for (const char* file : {"pipe.obj", "/dev/zero"}) {
    refused(stiff_scene(file), file);
    write("m.obj", "mtllib " + std::string(file) + "\n" + cube(1));
    refused(stiff_scene("cube.obj", ", visual: {mesh: m.obj}") + picture, "is not a regular file");
    write("m.mtl", "newmtl a\nmap_Kd " + std::string(file) + "\n"), write("m.obj", "mtllib m.mtl\nusemtl a\n" + cube(1));
    refused(stiff_scene("cube.obj", ", visual: {mesh: m.obj}") + picture, "is not a regular file");
  }
  write("m.mtl", "newmtl a\nmap_Kd .\n");
  refused(stiff_scene("cube.obj", ", visual: {mesh: m.obj}") + picture, "it is a folder");
  // Signature and header of a grey PNG of 23000 x 23000: nothing of it is unpacked.
  const unsigned char png[] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0,   0,   0x59, 0xD8, 0, 0, 0x59,
                               0xD8, 8,   0,   0,   0,  0,  0,  0,  0, 0, 0, 0,  0,   0,   'I', 'D', 'A', 'T', 0,    0,    0, 0};
  write("big.png", std::string(reinterpret_cast<const char*>(png), sizeof png));
  write("m.mtl", "newmtl a\nmap_Kd big.png\n");
  refused(stiff_scene("cube.obj", ", visual: {mesh: m.obj}") + picture, "has 23000 x 23000 pixels");
  write("nested.obj", cube(1, true, true));
  refused(stiff_scene("nested.obj"), "lies inside of another part");
  write("hollow.obj", cube(1, true, false));
  write("s.yaml", stiff_scene("hollow.obj"));
  EXPECT_EQ(mortise("check " + at("s.yaml")).code, 0);
}

TEST_F(Guard, ScenesThatAreMadeToHurt) {
  std::string keys = read_text(at("a.yaml"));
  for (int i = 0; i < 20000; ++i) keys += "unknown_key_" + std::to_string(i) + ": 1\n";
  write("s.yaml", keys);
  Result r;
  EXPECT_LT(seconds([&] { r = mortise("check " + at("s.yaml")); }), 10);
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(r.err, HasSubstr("and 19900 more errors"));
  std::string aliases = "mortise: 1\nname: &n \"" + std::string(1 << 20, 'x') + "\"\nlist: [";
  for (int i = 0; i < 200; ++i) aliases += "*n, ";
  write("s.yaml", aliases + "1]\n");
  r = mortise("check " + at("s.yaml"));
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(r.err, HasSubstr("longer than 64 MiB"));
  write("s.yaml", read_text(at("a.yaml")) + "\"evil\\e[2J\\nerror: forged\": 1\n");
  r = mortise("check " + at("s.yaml"));
  EXPECT_THAT(r.err, Not(HasSubstr("\033")));
  EXPECT_THAT(r.err, Not(HasSubstr("\nerror: forged")));
  EXPECT_THAT(r.err, HasSubstr("\\x1b[2J\\nerror: forged"));
}

TEST_F(Guard, LittleAddressSpaceIsAnError) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer reserves terabytes of addresses";
#endif
  for (const int kib : {150000, 300000, 600000, 1000000}) {
    const std::string command = "bash -c 'ulimit -v " + std::to_string(kib) + "; timeout -s KILL 20 " + kProgram + " run " + at("a.yaml") +
                                " --no-render -q -o " + at("out") + " 2>" + at("err") + "'";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 4) << kib;
    EXPECT_THAT(read_text(at("err")), HasSubstr("ulimit -v")) << kib;
  }
}

TEST_F(Guard, CheckRefusesWhatRunRefuses) {
  const auto both = [&](const std::string& text, const std::string& says) {
    write("s.yaml", text);
    const Result check = mortise("check " + at("s.yaml")), run = mortise("run " + at("s.yaml") + " --overwrite -q -o " + at("o"));
    EXPECT_EQ(check.code, 3) << check.err;
    EXPECT_EQ(run.code, 3) << run.err;
    EXPECT_THAT(check.err, HasSubstr(says));
  };
  const std::string good = read_text(at("a.yaml"));
  both(good + "render: {width: 16384, height: 64, cameras: {c: {position: [0.1, 0.1, 0.1], look_at: [0, 0, 0]}}}\n", "render.width is 16384");
  both(good + "render: {width: 64, height: 64, cameras: {c: {position: [0, 0, 1], look_at: [0, 0, 0], up: [0, 0, 1]}}}\n", "line of sight");
  std::string low = good;
  low.replace(low.find("5.08 mm"), 7, "4.08 mm");
  both(low, "bodies must start apart");
}

// Two contact effects in a scene: what both report of the points is their sum.
TEST_F(Guard, TwoContactEffectsWriteOneField) {
  write(
      "a.yaml",
      std::string(kHead) + "bodies:\n" + kBlock +
          "  upper: {type: soft, shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 10 mm}}, material: gel, position: [0, 0, 15.16 mm], "
          "velocity: [0, 0, -0.1]}\n" +
          "effects:\n  inertia: {}\n  gravity: {}\n  elasticity: {}\n  barrier_contact: {d_hat: 0.1 mm, stiffness: 10 kPa, pairs: [[upper, block]]}\n"
          "  mortar_contact: {d_hat: 0.1 mm, stiffness: 10 kPa, pairs: [{slave: block, master: floor}]}\n");
  const Result r = run("-q");
  ASSERT_EQ(r.code, 0) << r.err;
  const output::FieldReader fields(at("out/fields.vtkhdf"));
  const auto force = fields.point_field("contact_force", 2).values;
  double sum = 0, parts = 0;
  for (std::size_t i = 2; i < force.size(); i += 3) sum += force[i];
  for (const char* effect : {"barrier_contact", "mortar_contact"})
    for (const char* body : {"force_block_z", "force_upper_z"}) parts += fields.scalar(effect, body, 2).values.at(0);
  EXPECT_GT(parts, 1e-4);
  EXPECT_NEAR(sum, parts, 1e-5 * parts);
}

}  // namespace mortise::cli
