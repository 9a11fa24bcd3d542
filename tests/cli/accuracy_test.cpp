// mortise run --accuracy as a user runs it, on a fall whose error is known: backward Euler falls too far by dt/t.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class AccuracyProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    std::ofstream(folder_ + "/fall.yaml")
        << "mortise: 1\nname: fall\ntime: {step: 10 ms, steps: 10}\nmaterials: {steel: {density: 7850 kg/m^3}}\n"
           "bodies:\n  box: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, material: steel}\n"
           "effects: {inertia: {}, gravity: {acceleration: [0, 0, -9.81]}, affine_body: {}}\n"
           "quantities:\n  - {name: fall, value: displacement, body: box, over: mean, axis: z, reference: -49.05 mm}\n";
  }
  void TearDown() override { fs::remove_all(folder_); }
  Result run(const std::string& more) const { return mortise("run fall.yaml -o out --threads 1 " + more, folder_); }
  nlohmann::json found() const { return nlohmann::json::parse(read_text(folder_ + "/out/accuracy.json")); }
  const std::string folder_ = (fs::temp_directory_path() / ("mortise_accuracy_cli_" + std::to_string(getpid()))).string();
};

TEST_F(AccuracyProgram, RefinesUntilTheEstimateHolds) {
  const Result r = run("--accuracy fall=4%");
  ASSERT_EQ(r.code, 0) << r.err << r.out;
  EXPECT_THAT(r.out, HasSubstr("reached"));
  EXPECT_THAT(r.err, Not(HasSubstr("do not end")));  // four times the step: 2.5 of them
  const auto j = found();
  const double value = j["goals"][0]["value"], estimate = j["goals"][0]["estimated_error"], error = std::abs(value + 0.04905);
  EXPECT_LT(error, 0.04 * 0.04905);
  EXPECT_GE(estimate, error * (1 - 1e-6));
  EXPECT_LT(estimate, 2 * error);
  EXPECT_EQ(j["settings"]["time.step"], "0.0025");  // 10, 5 and 2.5 ms are wrong by 10, 5 and 2.5 %
  // What is in the folder is that run, and what is written as a scene gives it again.
  EXPECT_TRUE(fs::exists(folder_ + "/out/fields.vtkhdf"));
  EXPECT_EQ(nlohmann::json::parse(read_text(folder_ + "/out/run.json"))["steps"]["count"], 40);
  EXPECT_EQ(mortise("run out/accurate.yaml -q --no-render -o again", folder_).code, 0);
  // Results are not overwritten unasked; asked, nothing is run twice.
  EXPECT_EQ(run("--accuracy fall=4%").code, 2);
  const Result again = run("--accuracy fall=4% --overwrite");
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, HasSubstr("(before)"));
}

// A block between a plate and its supports: F = E A travel / L = 2 N, and the layer's gap adds 17 % to it.
TEST_F(AccuracyProgram, AStaticRunSaysItselfWhatItsLayerAdds) {
  std::ofstream(folder_ + "/patch.yaml")
      << "mortise: 1\nname: patch\ntime: {mode: static, steps: 1}\n"
         "materials: {gel: {model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}}\n"
         "bodies:\n"
         "  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [10 mm, 10 mm, 5 mm]}\n"
         "  plate: {type: stiff, shape: {box: {size: [30 mm, 30 mm, 4 mm], edge_length: 6 mm}}, material: gel, position: [10 mm, 10 mm, 12.2 mm]}\n"
         "effects:\n  elasticity: {}\n  pin:\n    - {body: block, where: {side: x_min}, axes: x}\n    - {body: block, where: {side: y_min}, axes: "
         "y}\n"
         "    - {body: block, where: {side: z_min}, axes: z}\n"
         "    - {body: plate, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -0.7 mm]]}}\n"
         "  mortar_contact: {d_hat: 0.1 mm, stiffness: 0.1 MPa, pairs: [{slave: block, master: plate}]}\n"
         "quantities: [{name: force, value: supports/plate_z}]\n";
  const Result r = mortise("run patch.yaml -o out --threads 1 --accuracy force=5%", folder_);
  ASSERT_EQ(r.code, 0) << r.err << r.out;
  EXPECT_THAT(r.out, HasSubstr("error budget"));
  const auto j = found();
  const double value = j["goals"][0]["value"], error = std::abs(value + 2);
  EXPECT_LT(error, 0.05 * 2);
  EXPECT_NEAR(j["goals"][0]["estimated_error"], error, 0.1 * error);
  EXPECT_EQ(j["runs"].size(), 2U) << "nothing beside the scene and the one that is right";
  EXPECT_EQ(j["settings"].size(), 1U);
  EXPECT_TRUE(j["settings"].contains("effects.mortar_contact.d_hat"));
}

// Its mesh is too stiff to bend: what a certificate knows beyond the estimates is told.
TEST_F(AccuracyProgram, TellsWhatTheCertificateDoubts) {
  std::ofstream(folder_ + "/strut.yaml")
      << "mortise: 1\nname: strut\ntime: {mode: static, steps: 4}\n"
         "materials: {gel: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}\n"
         "bodies:\n"
         "  col: {type: soft, shape: {box: {size: [10 mm, 10 mm, 150 mm], edge_length: 5 mm}}, material: gel, position: [0, 0, 75 mm]}\n"
         "effects:\n  elasticity: {}\n"
         "  pin:\n    - {body: col, where: {side: z_min}}\n"
         "    - {body: col, where: {side: z_max}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -3.4 mm]]}}\n"
         "quantities: [{name: way, value: displacement, body: col, point: [0, 0, 75 mm], axis: z}]\n";
  const Result r = mortise("run strut.yaml -o strut --threads 1 --no-render --accuracy way=5%", folder_);
  EXPECT_THAT(r.out, HasSubstr("is graded for, C: buckling is 0.5")) << r.err;
}

// A rod falls into its support: its largest force is wrong by the step, and by next to nothing for its mesh.
TEST_F(AccuracyProgram, RefinesWhatLeavesMost) {
  std::ofstream(folder_ + "/rod.yaml")
      << "mortise: 1\nname: rod\ntime: {step: 1 ms, steps: 30}\n"
         "materials: {rub: {youngs_modulus: 0.1 MPa, poisson_ratio: 0, density: 1000}}\n"
         "bodies:\n  rod: {type: soft, shape: {box: {size: [20 mm, 20 mm, 100 mm], edge_length: 8 mm}}, material: rub}\n"
         "effects: {inertia: {integrator: backward_euler}, elasticity: {}, gravity: {}, pin: [{body: rod, where: {side: z_max}}]}\n"
         "quantities: [{name: most, value: supports/rod_z, when: largest}]\n";
  const Result r = mortise("run rod.yaml -o out --threads 1 --accuracy most=15%", folder_);
  EXPECT_EQ(r.code, 0) << r.err << r.out;
  for (const auto& run : found()["runs"]) EXPECT_THAT(run["label"].get<std::string>(), Not(HasSubstr("mesh /")));
}

TEST_F(AccuracyProgram, NamesQuadraticElementsWhereLinearOnesAreWrong) {
  std::ofstream(folder_ + "/beam.yaml")
      << "mortise: 1\nname: beam\ntime: {mode: static, steps: 1}\n"
         "materials: {rub: {model: linear, youngs_modulus: 10 MPa, poisson_ratio: 0, density: 1000}}\n"
         "bodies:\n  beam: {type: soft, shape: {box: {size: [100 mm, 10 mm, 5 mm], edge_length: 2.5 mm}}, material: rub}\n"
         "effects:\n  elasticity: {}\n  pin: [{body: beam, where: {side: x_min}}, {body: beam, where: {side: x_max}, motion: {time: [0, 1], "
         "translation: [[0, 0, 0], [0, 0, -0.5 mm]]}}]\n"
         "quantities: [{name: energy, value: elasticity/energy}]\n";
  const Result r = mortise("run beam.yaml -o out --threads 1 --accuracy energy=1% --accuracy-budget '1.5 s'", folder_);
  EXPECT_EQ(r.code, 7) << r.err << r.out;
  EXPECT_THAT(r.out, HasSubstr("--set bodies.beam.order=2"));
}

TEST_F(AccuracyProgram, SaysWhatItCouldNotReach) {
  const Result r = run("--accuracy fall=0.1% --accuracy-budget '0.6 s'");
  EXPECT_EQ(r.code, 7) << r.err << r.out;
  EXPECT_THAT(r.out, HasSubstr("not reached"));
  EXPECT_FALSE(found()["reached"]);
  EXPECT_TRUE(fs::exists(folder_ + "/out/run.json"));
}

TEST_F(AccuracyProgram, RefusesWhatMakesNoSense) {
  EXPECT_THAT(run("--accuracy fal=4%").err, HasSubstr("did you mean 'fall'?"));
  for (const char* wrong : {"--accuracy fall=4", "--accuracy fall=80%", "--accuracy fall=4% --accuracy fall=2%", "--accuracy fall=4% --frames 2",
                            "--accuracy-budget '1 s'"})
    EXPECT_EQ(run(wrong).code, 2) << wrong;
  EXPECT_FALSE(fs::exists(folder_ + "/out/run.json"));
  const Result none = mortise("run " + kSource + "/scenes/first/01_free_fall.yaml -o out --accuracy x=1%", folder_);
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("quantities:"));
}

}  // namespace
}  // namespace mortise::cli
