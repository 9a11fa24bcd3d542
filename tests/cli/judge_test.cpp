// mortise_judge on field files with known faults.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "output/field_file.h"
#include "program.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

// Two unit tetrahedra, the second moved by `shift`; its first vertex by `push` more in the frame.
nlohmann::json judged(const Vec3& shift, const Vec3& push, const std::string& effects, double kinetic = 0, double elastic = NAN) {
  const std::string path = (fs::temp_directory_path() / ("mortise_judge_" + std::to_string(getpid()))).string();
  output::OutputMesh mesh;
  mesh.body_names = {"a", "b"};
  mesh.offsets = {0, 4, 8};
  mesh.types = {output::tetrahedron, output::tetrahedron};
  for (int b = 0; b < 2; ++b) {
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) mesh.points.push_back(x + (b ? Vec3(shift) : Vec3(0, 0, 0)));
    for (int k = 0; k < 4; ++k) mesh.connectivity.push_back(4 * b + k), mesh.body_of_point.push_back(b);
    mesh.body_of_cell.push_back(b);
  }
  const std::string scene =
      "bodies: {a: {type: soft, material: m}, b: {type: soft, material: m}, ground: {type: half_space, point: [0, 0, -1], normal: [0, 0, 1]}}\n"
      "materials: {m: {density: 6, model: linear, youngs_modulus: 60, poisson_ratio: 0}}\noutput: {precision: double}\neffects: {" +
      effects + "}\n";
  std::vector<double> now;
  for (const Vec3& x : mesh.points) now.insert(now.end(), x.data(), x.data() + 3);
  for (int c = 0; c < 3; ++c) now[12 + c] += push[c];
  output::FieldOptions options;
  options.double_precision = true, options.xdmf = false;
  {
    const auto file = output::FieldFile::open(path, mesh, {"", "", scene, ""}, options);
    file->begin_frame(0, now);
    file->points("velocity", "m/s", 3, std::vector<double>(24, 1.0));
    file->scalar("inertia", "kinetic_energy", "J", kinetic > 0 ? kinetic : 3);  // 2 kg at sqrt(3) m/s
    for (const char* axis : {"x", "y", "z"}) file->scalar("inertia", std::string("momentum_") + axis, "kg m/s", 2);
    if (std::isfinite(elastic)) file->scalar("elasticity", "energy", "J", elastic);
    file->end_frame();
    file->close();
  }
  const std::string command = test_place::kBuildFolder + "/bin/mortise_judge " + path + " > " + path + ".json";
  const int status = std::system(command.c_str());
  auto j = nlohmann::json::parse(read_text(path + ".json"), nullptr, false);
  j["code"] = WEXITSTATUS(status);
  fs::remove(path), fs::remove(path + ".json");
  return j;
}

const std::string kAll = "barrier_contact: {d_hat: 1}";

TEST(Judge, PassesWhatIsSound) {
  const auto j = judged({2, 0, 0}, {0, 0, 0}, kAll);
  EXPECT_EQ(j["code"], 0) << j;
  EXPECT_NEAR(j["min_det_f"], 1, 1e-15);
  EXPECT_LT(j["kinetic_energy_error"], 1e-12);
  EXPECT_LT(j["momentum_error"], 1e-12);
}

// A vertex pushed by p along x: strains -p, -p/2, -p/2 in 1/6 m^3 of 60 Pa are 10 p^2 joules.
TEST(Judge, RecomputesElasticEnergy) {
  const Vec3 push(0.1, 0, 0);
  EXPECT_EQ(judged({2, 0, 0}, push, kAll + ", elasticity: {}", 0, 0.1)["code"], 0);
  const auto j = judged({2, 0, 0}, push, kAll + ", elasticity: {}", 0, 0.10001);
  EXPECT_EQ(j["code"], 1);
  EXPECT_EQ(j["what"], "the elastic energy that was reported is not that of the saved positions") << j;
}

TEST(Judge, SeesBodiesThatMeetOnlyWhereContactIsWatched) {
  EXPECT_GT(judged({0.2, 0.2, 0.2}, {0, 0, 0}, kAll)["intersections"], 0);
  EXPECT_EQ(judged({0.2, 0.2, 0.2}, {0, 0, 0}, kAll)["code"], 1);
  EXPECT_GT(judged({0, 0, 1}, {0, 0, 0}, kAll)["intersections"], 0) << "one point in common";
  EXPECT_EQ(judged({0.2, 0.2, 0.2}, {0, 0, 0}, "barrier_contact: {pairs: [[a, ground]]}")["intersections"], 0);
  EXPECT_GT(judged({0.2, 0.2, 0.2}, {0, 0, 0}, "mortar_contact: {pairs: [{slave: b, master: a}]}")["intersections"], 0);
}

TEST(Judge, SeesInversionHalfSpacesAndWrongEnergies) {
  EXPECT_EQ(judged({3, 0, 0}, {0.5, 0.5, 0.5}, kAll)["inverted"], 1);
  EXPECT_EQ(judged({3, 0, -1.5}, {0, 0, 0}, kAll)["below_planes"], 3);
  const auto j = judged({2, 0, 0}, {0, 0, 0}, kAll, 3.1);
  EXPECT_NEAR(j["kinetic_energy_error"], 0.1 / 3, 1e-12);
  EXPECT_EQ(j["code"], 1);
}

TEST(Judge, SeesHeldBodiesUnlessTheyMoveAsOneOrMayPass) {
  const auto pin = [](const std::string& of, const std::string& more) { return "{body: " + of + ", where: {side: all}" + more + "}"; };
  const std::string moves = ", motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, 1]]}";
  const Vec3 in(0.2, 0.2, 0.2), none(0, 0, 0);
  EXPECT_GT(judged(in, none, kAll + ", pin: [" + pin("a", "") + ", " + pin("b", moves) + "]")["intersections"], 0);
  EXPECT_GT(judged(in, none,
                   "mortar_contact: {pairs: [{slave: a, master: ground}]}, pin: [" + pin("a", "") + ", " + pin("b", moves) + "]")["intersections"],
            0);
  EXPECT_EQ(judged(in, none, kAll + ", pin: [" + pin("a", moves) + ", " + pin("b", moves) + "]")["intersections"], 0);
  EXPECT_EQ(judged(in, none, kAll + ", pin: [" + pin("a", "") + ", " + pin("b", "") + "]")["intersections"], 0);
  EXPECT_EQ(judged(in, none, kAll + "}\npairs: [{bodies: [b, a], collide: false}]\nx-rest: {")["intersections"], 0);
  EXPECT_GT(judged({3, 0, -1.5}, none, kAll + ", pin: [" + pin("b", moves) + "]")["below_planes"], 0);
}

// A file of one body, and in two static frames what acts on it.
struct Pushed {
  Vec3 contact{0, 0, 3}, support{0, 0, -3};
  double residual = 1e-6;
  bool quadratic = false;
  Vec3 middle{0.5, 0.5, 0};  // of the edge between the second and the third corner, in the second frame
  Vec3 other{5, 0, 0};       // where another body lies
};
std::string write(const Pushed& p, const std::string& name) {
  const std::string path = (fs::temp_directory_path() / (name + std::to_string(getpid()))).string();
  output::OutputMesh mesh;
  mesh.body_names = {"a", "b"};
  std::vector<Vec3> corners{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.offsets = {0};
  for (int b = 0; b < 2; ++b) {
    std::vector<Vec3> nodes = corners;
    if (p.quadratic && b == 0)
      for (const auto& [i, k] : {std::pair{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}) nodes.push_back(0.5 * (corners[i] + corners[k]));
    for (const Vec3& x : nodes) {
      mesh.connectivity.push_back(static_cast<long>(mesh.points.size())), mesh.body_of_point.push_back(b);
      mesh.points.push_back(b ? Vec3(x + p.other) : x);
    }
    mesh.offsets.push_back(static_cast<long>(mesh.connectivity.size()));
    mesh.types.push_back(p.quadratic && b == 0 ? output::quadratic_tetrahedron : output::tetrahedron);
    mesh.body_of_cell.push_back(b);
  }
  const std::string scene =
      "bodies: {a: {type: soft, material: m}, b: {type: soft, material: m}}\nmaterials: {m: {density: 6, youngs_modulus: 1.0e+6, poisson_ratio: "
      "0.3}}\ntime: {mode: static, steps: 1, frame_every: 1}\n"
      "output: {precision: double}\neffects: {barrier_contact: {d_hat: 1}, pin: [{body: a, where: {side: z_min}}]}\n";
  output::FieldOptions options;
  options.double_precision = true, options.xdmf = false;
  {
    const auto file = output::FieldFile::open(path, mesh, {"", "", scene, ""}, options);
    for (int frame = 0; frame < 2; ++frame) {
      std::vector<double> now, contact(3 * mesh.points.size(), 0.0), support = contact;
      for (const Vec3& x : mesh.points) now.insert(now.end(), x.data(), x.data() + 3);
      if (p.quadratic)
        for (int c = 0; c < 3; ++c) now[3 * 5 + c] = p.middle[c];
      for (int c = 0; c < 3; ++c) contact[3 + c] = p.contact[c], support[6 + c] = p.support[c];
      output::StepRow step;
      step.substeps = 1, step.residual = p.residual;
      if (frame == 1) file->append_step(step);
      file->begin_frame(frame, now);
      file->points("contact_force", "N", 3, contact), file->points("support_force", "N", 3, support);
      file->end_frame();
    }
    file->close();
  }
  return path;
}
nlohmann::json judged(const Pushed& p) {
  const std::string path = write(p, "mortise_pushed_");
  const int status = std::system((test_place::kBuildFolder + "/bin/mortise_judge " + path + " > " + path + ".json").c_str());
  auto j = nlohmann::json::parse(read_text(path + ".json"), nullptr, false);
  j["code"] = WEXITSTATUS(status);
  fs::remove(path), fs::remove(path + ".json");
  return j;
}
std::string difference(const Pushed& p, const Pushed& q) {
  const std::string a = write(p, "mortise_one_"), b = write(q, "mortise_other_");
  const int status = std::system((test_place::kBuildFolder + "/bin/mortise_judge " + a + " " + b + " > " + a + ".txt").c_str());
  const std::string text = read_text(a + ".txt");
  EXPECT_EQ(WEXITSTATUS(status), text == "\n" ? 0 : 1);
  for (const std::string& file : {a, b, a + ".txt"}) fs::remove(file);
  return text;
}

TEST(Judge, AddsUpTheForcesOnEveryBody) {
  const auto sound = judged(Pushed{});
  EXPECT_EQ(sound["code"], 0) << sound;
  EXPECT_EQ(sound["forces_judged"], 2);
  const auto wrong = judged(Pushed{.support = {0, 0, -2.9}});
  EXPECT_EQ(wrong["code"], 1);
  EXPECT_EQ(wrong["what"], "the forces on a do not add up: 0.100000 N are left");
  EXPECT_EQ(judged(Pushed{.support = {0, 0, -2.9}, .residual = 0.03})["code"], 0) << "four nodes, each with this residual";
  EXPECT_EQ(judged(Pushed{.contact = {0, 0, 3e-10}, .support = {0, 0, 0}, .residual = 1e-14})["code"], 0) << "no more than rounding of positions";
  EXPECT_EQ(judged(Pushed{.contact = {0, 0, 3e-7}, .support = {0, 0, 0}, .residual = 1e-14})["code"], 1);
}

TEST(Judge, SeesTheQuartersOfQuadraticFaces) {
  EXPECT_EQ(judged(Pushed{.quadratic = true})["intersections"], 0);
  EXPECT_GT(judged(Pushed{.quadratic = true, .middle = {0.9, 0.9, 0}, .other = {0.6, 0.6, -0.1}})["intersections"], 0);
  EXPECT_EQ(judged(Pushed{.quadratic = true, .middle = {0.3, 0.3, 0}, .other = {0.4, 0.4, -0.1}})["intersections"], 0)
      << "the flat triangles of corners meet";
}

// A run of a scene, judged; and judged again where the scene that it holds is another.
class Ran {
 public:
  explicit Ran(const std::string& scene) {
    fs::create_directories(folder_);
    std::ofstream(folder_ + "/scene.yaml") << scene;
    const Result r = mortise("run scene.yaml -o out -q --no-render", folder_);
    EXPECT_EQ(r.code, 0) << r.err;
  }
  ~Ran() { fs::remove_all(folder_); }
  nlohmann::json judged() const {
    const std::string command = test_place::kBuildFolder + "/bin/mortise_judge " + fields_ + " > " + folder_ + "/j.json";
    const int status = std::system(command.c_str());
    auto j = nlohmann::json::parse(read_text(folder_ + "/j.json"), nullptr, false);
    j["code"] = WEXITSTATUS(status);
    return j;
  }
  void swap(const std::string& from, const std::string& to) const {
    std::string bytes = read_text(fields_);
    const std::size_t at = bytes.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    ASSERT_EQ(from.size(), to.size());
    bytes.replace(at, from.size(), to);
    std::ofstream(fields_, std::ios::binary) << bytes;
  }

 private:
  const std::string folder_ = (fs::temp_directory_path() / ("mortise_judged_" + std::to_string(getpid()))).string(),
                    fields_ = folder_ + "/out/fields.vtkhdf";
};

// A thrown, tumbling body whose stated inertia is not that of its shape, and one without a stated centre: energies, momentum and forces are its own.
TEST(Judge, KnowsMassThatIsSpreadAsStated) {
  const Ran run(R"(
mortise: 1
time: {step: 2 ms, steps: 10}
bodies:
  a: {type: stiff, mass: 0.3, shape: {box: {size: [0.2, 0.1, 0.1], edge_length: 0.1}}, position: [1, 2, 3], rotation: {axis: [1, 2, 3], angle: 50 deg},
      inertia: {centre: [0.05, 0.01, -0.02], moments: [0.002, 0.003, 0.004], products: [0.0004, 0, -0.0003]}, velocity: [1, 0, 2], angular_velocity: [3, -4, 5]}
  b: {type: stiff, mass: 0.5, shape: {parts: [{shape: {box: {size: [0.2, 0.1, 0.1], edge_length: 0.2}}}, {shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.1}}, position: [0.3, 0, 0]}]},
      inertia: {moments: [0.002, 0.003, 0.004]}, angular_velocity: [0, 6, 1]}
effects: {inertia: {}, gravity: {}, affine_body: {}}
output: {precision: double}
)");
  const auto sound = run.judged();
  EXPECT_EQ(sound["code"], 0) << sound;
  EXPECT_LT(sound["kinetic_energy_error"], 1e-9) << sound;
  EXPECT_LT(sound["momentum_error"], 1e-9) << sound;
  EXPECT_LT(sound["gravity_energy_error"], 1e-9) << sound;
  EXPECT_EQ(sound["forces_judged"], 20);
  run.swap("moments: [0.002, 0.003, 0.004]", "moments: [0.002, 0.003, 0.003]");
  EXPECT_EQ(run.judged()["code"], 1) << "another moment of inertia";
}

// A turning palm carries two fingers: a motor pushes one along an axis that turns along, the other goes 1.5 times as far the other way.
TEST(Judge, KnowsMotorsGuidesAndMimicryOfSlides) {
  const std::string finger = "{type: stiff, mass: 0.1, shape: {box: {size: [0.02, 0.02, 0.1], edge_length: 0.1}}, position: ";
  const Ran run(R"(
mortise: 1
time: {step: 5 ms, steps: 20}
bodies:
  palm: {type: stiff, mass: 0.5, shape: {box: {size: [0.2, 0.05, 0.02], edge_length: 0.2}}}
  left: )" + finger +
                R"([-0.05, 0, -0.1]}
  right: )" + finger +
                R"([0.05, 0, -0.1]}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  pin: [{body: palm, where: {side: all}, motion: {time: [0, 0.1], translation: [[0, 0, 0], [0.01, 0, 0.02]], rotation: {axis: [0, 1, 0], angle: [0, 0.5]}, interpolation: smooth}}]
  joint:
    - {name: one, type: prismatic, body: left, to: palm, axis: [2, 0, 0], travel_limits: [-2 mm, 20 mm]}
    - {name: two, type: prismatic, body: right, to: palm, axis: [-1, 0, 0], mimic: {joint: one, ratio: 1.5}}
  drive: [{joint: one, mode: effort, force: 3, damping: 5}]
output: {precision: double}
)");
  const auto sound = run.judged();
  EXPECT_EQ(sound["code"], 0) << sound;
  EXPECT_EQ(sound["forces_judged"], 60);
  run.swap("axis: [-1, 0, 0]", "axis: [-1, 0, 1]");
  EXPECT_EQ(run.judged()["code"], 1) << "another share of what the second finger bears";
}

// A palm that flies carries a finger on a slide, which carries another across; it goes half as far as the first, by a force.
TEST(Judge, KnowsGuidesAndMimicryOnFreeBodies) {
  const std::string finger = "{type: stiff, mass: 0.1, shape: {box: {size: [0.02, 0.02, 0.1], edge_length: 0.1}}, position: ";
  const Ran run(R"(
mortise: 1
time: {step: 5 ms, steps: 20}
bodies:
  palm: {type: stiff, mass: 0.5, shape: {box: {size: [0.2, 0.05, 0.02], edge_length: 0.2}}, angular_velocity: [0, 2, 1]}
  left: )" + finger +
                R"([-0.05, 0, -0.1]}
  right: )" + finger +
                R"([0.05, 0, -0.1]}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  joint:
    - {name: one, type: prismatic, body: left, to: palm, axis: [2, 0, 0], travel_limits: [-2 mm, 20 mm]}
    - {name: two, type: prismatic, body: right, to: left, axis: [0, 1, 0], mimic: {joint: one, ratio: 0.5}}
  drive: [{joint: one, mode: pd, kp: 300, kd: 5, travel: 15 mm}]
output: {precision: double}
)");
  const auto sound = run.judged();
  EXPECT_EQ(sound["code"], 0) << sound;
  EXPECT_EQ(sound["forces_judged"], 60);
  run.swap("ratio: 0.5", "ratio: 0.8");
  EXPECT_EQ(run.judged()["code"], 1) << "more of the force that moves the second is missing on the first";
}

TEST(Judge, ComparesFilesBitForBit) {
  EXPECT_EQ(difference(Pushed{}, Pushed{}), "\n");
  EXPECT_EQ(difference(Pushed{}, Pushed{.contact = {0, 0, 3 + 1e-15}}), "VTKHDF/PointData/contact_force differs\n");
}

}  // namespace
}  // namespace mortise::cli
