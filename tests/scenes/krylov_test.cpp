// Conjugate gradients inside Newton's method: preconditioners and forcing change the cost, not the answer.
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A driven soft ball on a bonded pad, and a stiff block that lies on it.
constexpr const char* kPress = R"(
mortise: 1
name: press
time: {step: 5 ms, steps: 4}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.4 MPa, poisson_ratio: 0.45, density: 1050}
  shell: {model: neo_hookean, youngs_modulus: 40 MPa, poisson_ratio: 0.3, density: 1800}
bodies:
  pad: {type: soft, shape: {box: {size: [20 mm, 20 mm, 5 mm], edge_length: 2 mm}}, material: gel, position: [0, 0, -2.5 mm]}
  ball: {type: soft, shape: {sphere: {radius: 5 mm, edge_length: 2 mm}}, material: shell, position: [0.3 mm, 0.2 mm, 5.05 mm]}
  block: {type: stiff, shape: {box: {size: [4 mm, 4 mm, 4 mm], edge_length: 4 mm}}, material: shell, position: [-7 mm, -7 mm, 2.05 mm]}
effects:
  inertia: {integrator: backward_euler}
  gravity: {acceleration: [0, 0, -9.81]}
  elasticity: {}
  affine_body: {stiffness: 100 MPa}
  pin:
    - {body: pad, where: {side: z_min}}
    - {body: ball, where: {box: {min: [-10 mm, -10 mm, 8 mm], max: [10 mm, 10 mm, 20 mm]}}, motion: {time: [0, 20 ms], translation: [[0, 0, 0], [0, 0, -0.6 mm]]}}
  barrier_contact: {d_hat: 0.1 mm, stiffness: 1 MPa}
solver: {relative_tolerance: 1e-8}
)";

struct Outcome {
  std::vector<double> points;
  Index cg = 0, newton = 0;
};
Outcome run(std::vector<std::string> sets) {
  for (std::string& s : sets) s = "solver." + s;
  Rig rig(kPress, sets);
  Outcome out;
  for (int i = 0; i < 4; ++i) {
    const solver::StepReport r = rig.step();
    out.cg += r.cg, out.newton += r.newton;
  }
  out.points = rig.engine->points();
  return out;
}
double farthest(const Outcome& a, const Outcome& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.points.size(); ++i) most = std::max(most, std::abs(a.points[i] - b.points[i]));
  return most;
}

}  // namespace

TEST(Krylov, TheAnswerDoesNotDependOnHowSystemsAreSolved) {
  const Outcome direct = run({"linear=direct"});
  for (const char* preconditioner : {"jacobi", "mas"})
    for (const char* forcing : {"fixed", "eisenstat_walker"})
      EXPECT_LT(farthest(direct, run({"linear=cg", std::string("preconditioner=") + preconditioner, std::string("cg_forcing=") + forcing})), 1e-8)
          << preconditioner << ", " << forcing << " [m]; the ball has moved by 6e-4 m";
}

TEST(Krylov, ForcingSavesNearlyHalfOfTheIterations) {
  const Outcome fixed = run({"linear=cg", "cg_forcing=fixed"}), forced = run({"linear=cg"});
  std::printf("cg %d, %d; newton %d, %d\n", fixed.cg, forced.cg, fixed.newton, forced.newton);
  EXPECT_LT(1.8 * forced.cg, fixed.cg);
  EXPECT_LT(forced.newton, 1.5 * fixed.newton);
}

TEST(Krylov, SchwarzSavesIterations) {
  const Outcome jacobi = run({"linear=cg", "preconditioner=jacobi", "cg_forcing=fixed"}),
                mas = run({"linear=cg", "preconditioner=mas", "cg_forcing=fixed"});
  std::printf("cg %d, %d\n", jacobi.cg, mas.cg);
  EXPECT_LT(1.5 * mas.cg, jacobi.cg);
}

TEST(Krylov, RunsRepeatBitForBit) {
  const std::vector<std::string> sets{"linear=cg", "preconditioner=mas"};
  EXPECT_EQ(run(sets).points, run(sets).points);
}

// Neither the preconditioner nor the forcing of a step knows the steps before it.
TEST(Krylov, RestartEqualsTheUnbrokenRun) {
  const std::vector<std::string> sets{"solver.linear=cg", "solver.preconditioner=mas"};
  Rig whole(kPress, sets), broken(kPress, sets);
  whole.steps(4);
  broken.steps(2);
  broken.resume();
  broken.steps(2);
  EXPECT_EQ(broken.engine->points(), whole.engine->points());
}
