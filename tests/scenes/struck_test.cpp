// What the time step takes from strikes (audit/struck.h): a jaw with a soft pad that a motor drives against a wall, and a block on a pad that falls,
// against runs of short steps.
#include <fmt/format.h>

#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Strike {
  double told = 0, force = 0;  // the largest on the pad [N]
};

Strike strike(const std::string& scene, double step, double end, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides = {fmt::format("time.step={}", step)};
  overrides.insert(overrides.end(), more.begin(), more.end());
  Rig rig(scene, overrides);
  Strike out;
  const auto look = [&](const solver::StepReport&, const Captured& said) {
    out.force = std::fmax(out.force, vector(said, "mortar_contact/force_pad_").norm());
  };
  out.told = audited(rig, std::lround(end / step), look).struck;
  return out;
}

std::string jaw(const std::string& force) {
  return R"(
mortise: 1
name: jaw
time: {step: 5 ms, steps: 1}
materials: {gel: {youngs_modulus: 0.4 MPa, poisson_ratio: 0.4, density: 1100}, al: {density: 2700}}
bodies:
  jaw: {type: stiff, shape: {box: {size: [10 mm, 24 mm, 40 mm], edge_length: 40 mm}}, material: al, position: [-20 mm, 0, 0]}
  pad: {type: soft, shape: {box: {size: [6 mm, 20 mm, 20 mm], edge_length: 6 mm}}, material: gel, position: [-12 mm, 0, 0]}
  wall: {type: stiff, shape: {box: {size: [10 mm, 40 mm, 40 mm], edge_length: 40 mm}}, material: al, position: [1 mm, 0, 0]}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {}
  pin: [{body: wall, where: {side: all}}]
  joint: [{name: slide, type: prismatic, body: jaw, axis: [1, 0, 0]}]
  drive: [{joint: slide, mode: effort, force: )" +
         force + R"(}]
  bond: [{body: pad, to: jaw, within: 0}]
  mortar_contact: {pairs: [{slave: pad, master: wall}]}
)";
}

const std::string kFalls = R"(
mortise: 1
name: falls
time: {step: 5 ms, steps: 1}
materials: {gel: {youngs_modulus: 0.4 MPa, poisson_ratio: 0.4, density: 1100}, al: {density: 2700}}
bodies:
  box: {type: stiff, shape: {box: {size: [40 mm, 40 mm, 20 mm], edge_length: 40 mm}}, material: al, position: [0, 0, 21 mm]}
  pad: {type: soft, shape: {box: {size: [40 mm, 40 mm, 10 mm], edge_length: 10 mm}}, material: gel, position: [0, 0, 6 mm]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  affine_body: {}
  bond: [{body: pad, to: box, within: 0}]
  mortar_contact: {pairs: [{slave: pad, master: floor}]}
)";

}  // namespace

// What comes after the first rise: a load that a spring carries strikes a second time, on pads that swing in five steps.
TEST(Struck, SeesPeaksThatComeLater) {
  const std::string hop = R"(
mortise: 1
name: hop
time: {step: 5 ms, steps: 1}
materials: {gel: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1050}}
bodies:
  trunk: {type: stiff, shape: {box: {size: [60 mm, 60 mm, 40 mm], edge_length: 30 mm}}, mass: 1, position: [0, 0, 200 mm]}
  leg: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 100 mm], edge_length: 20 mm}}, mass: 0.1, position: [0, 0, 70 mm]}
  foot: {type: soft, shape: {box: {size: [20 mm, 20 mm, 15 mm], edge_length: 5 mm}}, material: gel, position: [0, 0, 12.5 mm]}
  floor: {type: half_space, point: [0, 0, 4.9 mm]}
effects:
  elasticity: {}
  affine_body: {}
  inertia: {integrator: bdf2}
  gravity: {}
  joint:
    - {name: rail, type: prismatic, body: trunk, axis: [0, 0, 1]}
    - {name: knee, type: prismatic, body: leg, to: trunk, axis: [0, 0, -1], travel_limits: [-20 mm, 60 mm]}
  drive: [{joint: knee, mode: pd, kp: 2000, kd: 20, effort: 60, travel: {time: [0, 100 ms, 150 ms, 200 ms, 250 ms], value: [4 mm, 4 mm, 54 mm, 54 mm, 4 mm]}}]
  bond: [{body: foot, to: leg, within: 1 um}]
  mortar_contact: {pairs: [{slave: foot, master: floor}]}
)";
  const auto of_foot = [&](double step) {
    Rig rig(hop, {fmt::format("time.step={}", step)});
    Strike out;
    const auto look = [&](const solver::StepReport&, const Captured& said) {
      out.force = std::fmax(out.force, std::abs(said.at("mortar_contact/force_foot_z")));
    };
    out.told = audited(rig, std::lround(0.5 / step), look).struck;
    return out;
  };
  const Strike fine = of_foot(1e-3), coarse = of_foot(5e-3);
  EXPECT_LT(coarse.force, 0.9 * fine.force);
  EXPECT_GT(coarse.told, 0.5 * (1 - coarse.force / fine.force)) << coarse.force << ' ' << fine.force;
  EXPECT_LT(fine.told, 0.05);
}

TEST(Struck, IsWhatTheLargestForceIsShortOf) {
  for (const auto& [scene, end] : {std::pair{jaw("5"), 0.04}, {kFalls, 0.03}}) {
    const double exact = strike(scene, 0.05e-3, end).force;
    for (const char* integrator : {"backward_euler", "bdf2"})
      for (const double step : {5e-3, 2.5e-3, 1e-3}) {
        const Strike run = strike(scene, step, end, {std::string("effects.inertia.integrator=") + integrator});
        const double missing = 1 - run.force / exact;
        EXPECT_NEAR(run.told, missing, 0.2) << integrator << " " << step << " " << run.force << " " << exact;
      }
  }
}

// What is put down, or pressed slowly, lacks nothing that anybody looks at.
TEST(Struck, IsNothingWhereNothingStrikes) {
  EXPECT_TRUE(std::isnan(strike(kFalls, 5e-3, 0.05, {"bodies.box.position=[0, 0, 0.02001]", "bodies.pad.position=[0, 0, 0.00501]"}).told))
      << "put down";
  EXPECT_LT(strike(jaw("{time: [0, 20 ms, 30 ms, 1 s], value: [0.1, 0.1, 0.1, 50]}"), 5e-3, 0.5).told, 0.05) << "pressed harder later";
}
