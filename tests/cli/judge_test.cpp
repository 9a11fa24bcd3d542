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
  const std::string scene = "bodies: {a: {type: soft, material: m}, b: {type: soft, material: m}, ground: {type: half_space, point: [0, 0, -1], normal: [0, 0, 1]}}\n"
                            "materials: {m: {density: 6, model: linear, youngs_modulus: 60, poisson_ratio: 0}}\noutput: {precision: double}\neffects: {" + effects + "}\n";
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

}  // namespace
}  // namespace mortise::cli
